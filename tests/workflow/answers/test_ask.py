"""``muscle ask``: the third of pressure, contraction and force, kept as a record."""

import json
import math
import subprocess
import sys
from pathlib import Path

import pytest

from solver import record
from solver.load_path import LoadPath
from workflow import answers
from workflow.__main__ import main
from workflow.answers import question
from workflow.answers.quick import Quick
from workflow.study import library
from workflow.study.errors import StudyError
from workflow.study.study import load, load_library

ROOT = Path(__file__).parents[3]
STUDY = ROOT / "config" / "config.yaml"
SLOW = ["scipy", "pandas", "xarray", "pint", "matplotlib"]


@pytest.fixture(scope="module")
def study():
    return load(STUDY)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("answers")


@pytest.fixture
def ask(study, folder, monkeypatch):
    """Questions about the muscle of the paper, in a folder that keeps its records."""
    monkeypatch.chdir(folder)
    return lambda muscle="dmsp20", **given: answers.ask(muscle, study=study, **given)


@pytest.mark.parametrize("model", ["cylinder", "membrane"])
def test_the_three_questions_have_one_state(ask, model):
    first = ask(pressure="2.5bar", contraction="10%", model=model)
    for given in (
        {"pressure": "0.25MPa", "force": first.force},
        {"contraction": "30mm", "force": first.force},
    ):
        other = ask(model=model, **given)
        assert other.pressure == pytest.approx(0.25, abs=1e-6)
        assert other.contraction == pytest.approx(0.1, abs=1e-6)
        assert other.force == pytest.approx(first.force, abs=1e-9)
        for name in ("stiffness", "volume", "outer_diameter", "thread_force", "rubber_stretch"):
            assert getattr(other, name) == pytest.approx(getattr(first, name), rel=2e-5), name


def test_numbers_of_the_muscle_of_the_paper(ask):
    """200 N hanging, by the membrane."""
    for pressure, contraction in zip((0.2, 0.3, 0.4), (0.06238, 0.12709, 0.17084), strict=True):
        found = ask(pressure=pressure, force="200N")
        assert found.contraction == pytest.approx(contraction, abs=1e-5)


def test_an_answer_is_a_record_and_asked_again_solves_nothing(ask):
    given = {"contraction": "7%", "force": "20kg"}
    first = ask(**given)
    assert first.solves > 0
    case, solution = record.read(Path("results/cases", f"{first.case}.h5"))
    assert case.key == first.case
    assert solution.code == record.code_digest("membrane")
    again = ask(**given)
    assert again.solves == 0
    assert again.force == first.force
    assert again.pressure == first.pressure


def test_a_record_of_other_sources_is_solved_again(ask):
    given = {"pressure": "0.3MPa", "contraction": "11%", "model": "cylinder"}
    first = ask(**given)
    path = Path("results/cases", f"{first.case}.h5")
    path.write_bytes(path.read_bytes()[:-1])
    assert ask(**given).solves == 1  # damaged
    case, solution = record.read(path)
    object.__setattr__(solution, "code", "0" * 16)
    record.write(path, case, solution)
    assert ask(**given).solves == 1
    assert ask(**given).solves == 0


def test_its_error_is_that_of_its_state(ask, study):
    """Where the muscle was measured; elsewhere by like muscles, or with a note."""
    near, far = (ask(pressure="0.3MPa", contraction=e) for e in ("7%", "14%"))
    assert near.error < 0.4 * far.error
    for found, e in ((near, "7%"), (far, "14%")):
        off = abs(found.force - ask(pressure="0.3MPa", contraction=e, model="solid").force)
        assert off < found.error
    assert not near.notes
    above = ask(pressure="0.45MPa", contraction="10%")  # by like muscles
    off = abs(above.force - ask(pressure="0.45MPa", contraction="10%", model="solid").force)
    assert off < above.error < 0.02 * 1000
    assert not above.notes
    soft = answers.ask("thin_2mm", pressure="0.3MPa", contraction="5%", study=load_library())
    assert "compared on a muscle like this one" in soft.notes[0]


def test_its_error_covers_the_more_exact_model(ask):
    """At a state where the caps matter."""
    by = {
        model: ask(pressure="0.3MPa", contraction="14%", model=model)
        for model in ("cylinder", "membrane", "solid")
    }
    for model in ("cylinder", "membrane"):
        off = abs(by[model].force - by["solid"].force)
        assert off < by[model].error < 3 * off
    assert by["solid"].error < by["membrane"].error
    asked = ask(pressure="0.3MPa", force="165N")
    off = abs(asked.contraction - ask(pressure="0.3MPa", force="165N", model="solid").contraction)
    assert off < asked.error < 3 * off


def test_a_tolerance_takes_a_model(ask):
    given = {"pressure": "0.3MPa", "contraction": "10%"}
    assert ask(**given, tolerance=0.1).model == "cylinder"
    assert ask(**given, tolerance=0.01).model == "membrane"
    assert ask(**given, tolerance=0.003).model == "solid"


def test_where_a_model_has_no_state_the_next_one_answers(ask):
    """The membrane ends by overhang at low pressure."""
    given = {"pressure": "0.05MPa", "contraction": "15%"}
    found = ask(**given)
    assert found.model == "solid"
    assert "membrane finds no such state" in found.notes[0]
    assert "pushed" in " ".join(found.notes)
    with pytest.raises(StudyError, match="membrane finds no such state"):
        ask(**given, model="membrane")


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"pressure": "0.3MPa"}, "two of pressure, contraction and force"),
        ({}, "nothing is given"),
        ({"pressure": 0.3, "contraction": 0.1, "force": 5.0}, "two of"),
        ({"muscle": "dmsp2", "pressure": 0.3, "contraction": 0.1}, "nearest: dmsp20"),
        ({"pressure": "-1bar", "contraction": "5%"}, "0 to 20 MPa"),
        ({"pressure": "300MPa", "contraction": "5%"}, "perhaps: 300 kPa, that is 0.3 MPa"),
        ({"pressure": "1bar", "contraction": "80%"}, "contraction 80 %"),
        ({"pressure": "2.5bar", "contraction": "280mm"}, "at rest, where it is 300 mm long"),
        ({"contraction": "10%", "force": "-5N"}, "0 N or more"),
        ({"pressure": "2.5bar", "contraction": "40%"}, "about 19 % by itself"),
        ({"pressure": "2.5bar", "force": "100kN"}, "at its length at rest"),
        ({"contraction": "40%", "force": "5N"}, "it gets shorter by 28.2 % at most"),
        ({"pressure": 0.3, "contraction": 0.1, "model": "membran"}, "nearest: membrane"),
        ({"pressure": 0.3, "contraction": 0.1, "tolerance": 2.0}, "between 0 and 1"),
        ({"pressure": 0.3, "contraction": 0.1, "variant": "papers"}, "nearest: paper"),
    ],
)
def test_a_question_that_makes_no_sense_is_answered_with_what_does(ask, given, said):
    with pytest.raises(StudyError) as refused:
        ask(**given)
    assert said in str(refused.value)


@pytest.mark.parametrize(
    ("given", "said"),
    [
        ({"pressure": "2.5bar", "contraction": "24%"}, "shorter by about 19 % alone"),
        ({"pressure": "0.2bar", "contraction": "5%"}, "at 5 % it pulls from about 0.08"),
        ({"pressure": "2.5bar", "force": "2kN"}, "at its length at rest it pulls about 573 N"),
    ],
)
def test_of_a_state_that_it_does_not_come_to_alone_it_is_said_what_it_does(ask, given, said):
    assert said in " ".join(ask(**given, model="cylinder").notes)


def test_of_no_pressure_there_is_no_error_to_guess_and_no_contraction_of_its_own(ask):
    found = ask(pressure="0bar", contraction="5%", model="cylinder")
    assert math.isnan(found.error)
    said = " ".join(found.notes)
    assert "its error" not in said
    assert "alone" not in said
    assert "it has to be pushed" in said


@pytest.mark.parametrize("model", ["geometric", "geometric_layers"])
def test_an_equation_without_a_slope_has_its_pressure(ask, model):
    first = ask(pressure="0.25MPa", contraction="12%", model=model)
    other = ask(contraction="12%", force=first.force, model=model)
    assert other.pressure == pytest.approx(0.25, abs=1e-6)


def test_the_command_prints_text_and_json(folder, monkeypatch, capsys):
    monkeypatch.chdir(folder)
    words = ["ask", "dmsp20", "0.3", "MPa", "10%", "--model", "cylinder", "--study", str(STUDY)]
    assert main(words) == 0
    said = capsys.readouterr().out
    assert said.startswith("dmsp20 at 0.3 MPa, 10 %, by cylinder:\n  force")
    assert "299.1 N  ±" in said
    assert main([*words, "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["force"] == {"value": pytest.approx(299.109, abs=1e-3), "unit": "N"}
    assert found["solves"] == 0
    between = ["ask", "--json", "dmsp20", "--study", str(STUDY), "0.3MPa", "--model", "cylinder"]
    assert main([*between, "10%"]) == 0  # options stand anywhere
    assert json.loads(capsys.readouterr().out)["force"] == found["force"]
    assert main([*words, "--pressure", "1bar"]) == 1
    assert "there is a pressure already" in capsys.readouterr().err


def test_a_fraction_beside_a_pressure_is_a_contraction(folder, monkeypatch, capsys):
    monkeypatch.chdir(folder)
    more = ["--model", "cylinder", "--study", str(STUDY)]
    for words in (["250kPa", "0.12"], ["0.12", "2.5", "bar"], ["0.12", "--pressure", "0.25"]):
        assert main(["ask", "dmsp20", *words, *more]) == 0
        assert capsys.readouterr().out.startswith("dmsp20 at 0.25 MPa, 12 %")
    for words in (["stroke", "36", "mm", "p=2.5bar"], ["pressure=0.25", "contraction", "0.12"]):
        assert main(["ask", "dmsp20", *words, *more]) == 0
        assert capsys.readouterr().out.startswith("dmsp20 at 0.25 MPa, 12 %")
    for words in (["50N", "0.12"], ["0.25", "0.12"], ["0.25MPa", "12"]):
        assert main(["ask", "dmsp20", *words, *more]) == 1
        assert "has no unit" in capsys.readouterr().err


def test_nothing_that_is_slow_to_import_is_imported(folder):
    """The first answer comes within two seconds: no SciPy, no pandas, no pint."""
    program = (
        "import sys; from workflow.__main__ import main; "
        f"main(['ask', 'dmsp20', '0.3MPa', '9%', '--study', {str(STUDY)!r}]); "
        f"print([name for name in {SLOW} if name in sys.modules])"
    )
    done = subprocess.run(
        [sys.executable, "-P", "-c", program],
        cwd=folder,
        env={"PATH": "/usr/bin:/bin", "PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout.splitlines()[-1] == "[]"


@pytest.mark.parametrize(("pressure", "contraction"), [(0.1, 0.0), (0.3, 0.1), (0.5, 0.2)])
def test_the_quick_look_is_its_own_inverse(study, pressure, contraction):
    quick = Quick(study.muscles["dmsp20"])
    force = quick.force(pressure, contraction)
    assert quick.pressure(contraction, force) == pytest.approx(pressure, abs=1e-9)
    assert quick.contraction(pressure, force) == pytest.approx(contraction, abs=1e-9)
    assert quick.state(pressure, contraction)["force"] == force


def test_a_muscle_of_the_library_needs_no_study(folder, tmp_path, monkeypatch):
    """Neither one that names it nor, where there is none, any."""
    name = library.names("muscles")[0]
    given = {"pressure": "0.3MPa", "contraction": "5%", "model": "cylinder"}
    monkeypatch.chdir(folder)
    first = answers.ask(name, **given, study=STUDY)
    monkeypatch.chdir(tmp_path)
    assert answers.ask(name, **given).force == first.force
    with pytest.raises(StudyError, match="no such muscle in library"):
        answers.ask("nothing", **given)


def test_where_threads_have_a_width_their_load_is_not_called_a_tension(make_case):
    path = LoadPath(kind="isobaric", held=0.3, stops=(0.1,))
    assert "its tension is less" in question.of_threads(make_case(model="cell", path=path))[0]
    assert question.of_threads(make_case(model="solid", path=path)) == ()
