"""What Snakemake runs: once each, again only for a reason, and everything that can be run."""

import fcntl

import pytest

from solver.sources import sources

from .project import STUDY

NET = {"Solving one geometric isobaric 0.2 MPa (and 1 more)"}
FIG90 = NET | {f"Solving {muscle} cylinder isobaric 0.2 MPa" for muscle in ("one", "soft")}
MEMBRANE = {"Solving one membrane isobaric 0.2 MPa"}
SOLID = {"Solving one solid isobaric 0.2 MPa"}
GATHER = {"Gathering the records of all cases"}
CHECK = "Checking that no case failed"  # at the end of every run
DRAW90, DRAW91 = {"Drawing fig90"}, {"Drawing fig91"}
AFTER = GATHER | DRAW90 | DRAW91
MESHED = MEMBRANE | SOLID
MESH_MEMBRANE, MESH_SOLID = (
    {job.replace("Solving", "Meshing") for job in jobs} for jobs in (MEMBRANE, SOLID)
)
MESHES = MESH_MEMBRANE | MESH_SOLID


@pytest.fixture
def edited(project):
    """Edits files and puts them back."""
    kept = {}

    def edit(path, change):
        kept.setdefault(path, project.read(path))
        text = change(project.read(path))
        assert text != project.read(path)
        project.write(path, text)

    yield edit
    for path, text in kept.items():
        project.write(path, text)


def test_everything_is_there_and_nothing_runs_again(project):
    results = project.folder / "results"
    for name in ("fig90", "fig91"):
        assert {p.suffix for p in results.glob(f"figures/{name}.*")} == {".png", ".svg", ".csv"}
    assert (results / "dataset.nc").exists()
    assert (results / "states.parquet").exists()
    assert len((results / "tables/failures.csv").read_text().splitlines()) == 1
    assert len(list(results.glob("cases/*.h5"))) == 5
    assert project.planned() == set()


def test_the_run_said_how_it_went(project):
    assert "5 of 5 cases solved, 0 failed" in project.said
    assert "5 of 5 cases solved" in project.read("results/logs/progress.log")
    own = next((project.folder / ".snakemake/log").iterdir()).read_text()
    for chatter in ("one solid isobaric 0.2 MPa (no record)", "Finished jobid"):
        assert chatter in own  # in Snakemake's log
    assert "Finished jobid" not in project.said


def test_nothing_runs_after_what_means_nothing(project, edited):
    for source in ("geometry", "solver", "workflow", "config"):
        for path in (project.folder / source).rglob("*.*"):
            path.touch()
    edited(
        "config/config.yaml",
        lambda text: (
            "# a comment\n"
            + text.replace("inner_diameter: 20\n", "inner_diameter: 20.0\n")
            .replace("    length: 60\n", "")
            .replace("    lead: 144\n", "    lead: 1.44e+2\n    length: 60\n")
            .replace("[0, 0.05]", "[0.050, 0.0]", 1)
            .replace("[one, soft]", "[soft, one]")
            .replace("wall_time: 60", "wall_time: 90")
        ),
    )
    assert project.planned() == set()


STUDY_CHANGES = [
    ("c10: 0.028", "c10: 0.03", {"Solving soft cylinder isobaric 0.2 MPa"} | GATHER | DRAW90),
    ("growth: 2}", "growth: 1.9}", MESH_SOLID | SOLID | GATHER | DRAW91),
    ("models: [membrane, solid]", "models: [membrane]", GATHER | DRAW91),
    ("soft", "weak", GATHER | DRAW90),
]


@pytest.mark.parametrize(("old", "new", "expected"), STUDY_CHANGES)
def test_a_changed_study_runs_what_contains_the_change(project, edited, old, new, expected):
    edited("config/config.yaml", lambda text: text.replace(old, new))
    assert project.planned() == {*expected, CHECK}


def test_swapped_values_are_noticed(project, edited):
    """Names that change places leave all cases as they were, but not what is gathered and drawn."""
    edited(
        "config/config.yaml",
        lambda text: (
            text.replace("  one:", "  x:")
            .replace("  soft: {base: one", "  one: {base: x")
            .replace("[one, soft]", "[one, x]")
            .replace("[one]", "[x]")
            .replace("x", "soft")
        ),
    )
    assert project.planned() == {*AFTER, CHECK}


COMMENT = {".py": "# edited\n", ".csv": "0.62,0.28,0,0\n"}
EDITS = {
    # source: what runs again when it is edited
    "geometry/muscle.py": MESHES | FIG90 | MESHED | AFTER,
    "geometry/grading.py": MESHES | FIG90 | MESHED | AFTER,
    "geometry/section.py": MESH_SOLID | SOLID | AFTER,
    "geometry/meridian.py": MESH_MEMBRANE | MEMBRANE | GATHER | DRAW91,
    "geometry/whole.py": set(),
    "solver/case.py": FIG90 | MESHED | AFTER,
    "solver/net.py": NET | AFTER,
    "solver/models/cylinder/curve.py": (FIG90 - NET) | GATHER | DRAW90,
    "solver/models/membrane/membrane.edp": MEMBRANE | GATHER | DRAW91,
    "solver/models/solid/solid.edp": SOLID | GATHER | DRAW91,
    "solver/models/solid/ends_clamp.idp": SOLID | GATHER | DRAW91,
    "solver/models/cell/cell.edp": set(),
    "solver/check.edp": set(),
    "solver/path/newton.idp": MESHED | GATHER | DRAW91,
    "workflow/figures/fig90.py": DRAW90,
    "workflow/figures/style.py": DRAW90 | DRAW91,
    "workflow/data/dataset.py": GATHER,
    "workflow/data/states.py": AFTER,
    "config/reference/festo_musclesim_dmsp20.csv": AFTER,
}


FOLLOWS = {  # what reads what these jobs make
    **dict.fromkeys(FIG90, GATHER | DRAW90),
    **dict.fromkeys(MESHED, GATHER | DRAW91),
}


@pytest.fixture(scope="module")
def read_by(project):
    """The jobs that read a source, by source: those that run again when it is edited, but for
    those that follow. Sources are edited all at once.
    """
    kept, found = {}, {}
    files = [*project.folder.glob("geometry/*.py"), *project.folder.glob("solver/**/*.*")]
    files += [*project.folder.glob("workflow/**/*.py"), *project.folder.glob("config/**/*.csv")]
    gathered = sources("workflow.programs.gather")
    for path in files:
        if "__pycache__" not in path.parts:
            kept[path] = path.read_text()
            path.write_text(kept[path] + COMMENT.get(path.suffix, "// edited\n"))
    reasons = project.reasons()
    for path, text in kept.items():
        path.write_text(text)
    for job, read in reasons.items():
        for source in read:
            found.setdefault(source, set()).add(job)
    for source in gathered:
        found.setdefault(source, set()).update(GATHER)
    return found


def with_followers(jobs):
    """Jobs and all that comes after them."""
    found = set(jobs)
    for job in jobs:
        found |= with_followers(FOLLOWS.get(job, ()))
    return found


@pytest.mark.parametrize("source", EDITS)
def test_an_edited_source_runs_what_reads_it(read_by, source):
    assert with_followers(read_by.get(source, ())) == EDITS[source]


def test_one_edited_source(project, edited):
    """That the jobs which follow do run."""
    edited("solver/models/solid/solid.edp", lambda text: text + "// edited\n")
    assert project.planned() - {CHECK} == EDITS["solver/models/solid/solid.edp"]


def test_a_deleted_record_is_solved_again(project):
    record = next((project.folder / "results/cases").glob("*.h5"))
    kept = record.rename(record.with_suffix(".kept"))
    planned = project.planned()
    kept.rename(record)
    assert sum(job.startswith("Solving") for job in planned) == 1


def test_a_wrong_study_stops_with_its_message(project, edited):
    edited("config/config.yaml", lambda text: text.replace("length: 60", "lenght: 60"))
    status, output = project.run("--dry-run")
    assert status == 1
    assert "config/config.yaml:8: muscles.one.lenght is no key here" in output
    assert "Traceback" not in output


def test_one_run_at_a_time(project, edited):
    edited("workflow/figures/fig90.py", lambda text: text + "# edited\n")
    with (project.folder / ".snakemake/run.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        lock.write("4711\n")
        lock.flush()
        status, output = project.run()
        assert status == 1
        assert "Another run works in this folder (process 4711)" in output
        assert "Traceback" not in output
        assert project.planned() == {*DRAW90, CHECK}  # a look is allowed


def test_a_failed_case_stops_nothing_else(project, tmp_path):
    project = project.copy(tmp_path / "project")
    hopeless = "variants:\n  hopeless: {numerics: {newton: {iterations: 1}}}\n"
    text = STUDY.replace("numerics:", hopeless + "numerics:", 1)
    project.write("config/config.yaml", text + "    variants: [default, hopeless]\n")
    status, output = project.run()
    results = project.folder / "results"
    assert status == 1
    assert "one membrane hopeless isobaric 0.2 MPa: stalled" in output
    assert (results / "dataset.nc").exists()
    assert (results / "figures/fig91.png").exists()
    assert not (results / "complete.txt").exists()
    rows = (results / "tables/failures.csv").read_text().splitlines()
    assert len(rows) == 3
    assert project.planned() == {CHECK}  # failed cases are not tried again
    status, output = project.run("retry", program=("workflow",))
    assert (status, len(output.splitlines())) == (0, 2)
    solved = {job for job in project.planned() if job.startswith("Solving")}
    assert solved == {f"Solving one {m} hopeless isobaric 0.2 MPa" for m in ("membrane", "solid")}


def test_a_mesh_that_cannot_be_made_is_a_failed_case(project, tmp_path):
    project = project.copy(tmp_path / "project")
    program = project.read("geometry/make.py")
    call = "    module.from_spec("
    broken = program.replace(call, f'    if kind == "section":\n        raise MemoryError\n{call}')
    assert broken != program
    project.write("geometry/make.py", broken)
    status, output = project.run()
    assert status == 1
    assert "one solid isobaric 0.2 MPa: mesh_failed" in output
    assert (project.folder / "results/dataset.nc").exists()
    project.write("geometry/make.py", program)
    project.run("retry", program=("workflow",))
    assert project.planned() == {*MESHES, *MESHED, *GATHER, *DRAW91, CHECK}
