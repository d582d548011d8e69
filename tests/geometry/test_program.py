"""``python -m geometry``: the files of the functions, and one message for what makes no sense."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

from geometry import __main__ as program
from geometry import gmsh_file, meridian, section, whole
from geometry.mesh_settings import MeridianMesh, SectionMesh

ROOT = Path(__file__).parents[2]


@pytest.fixture
def specs(muscle):
    plain = muscle.as_dict()
    return {
        "meridian": {"kind": "meridian", "muscle": plain, "mesh": {"growth": 1.2}},
        "section": {"kind": "section", "muscle": plain, "mesh": {"rows": [1, 2, 1]}, "end": "butt"},
        "whole": {"kind": "whole", "muscle": plain},
    }


def run(spec, output, text=None):
    """The program in a process of its own, fed through standard input."""
    return subprocess.run(
        [sys.executable, "-m", "geometry", "-", str(output)],
        input=json.dumps(spec) if text is None else text,
        capture_output=True,
        text=True,
        cwd=ROOT,
        check=False,
    )


@pytest.mark.parametrize("kind", ["meridian", "section", "whole"])
def test_writes_what_the_function_writes(kind, specs, muscle, tmp_path):
    made, expected = tmp_path / "made", tmp_path / "expected"
    if kind == "meridian":
        meridian.write(muscle, MeridianMesh(growth=1.2), expected)
    elif kind == "section":
        section.write(muscle, SectionMesh(rows=(1, 2, 1)), "butt", expected)
    else:
        whole.write(muscle, expected)
    done = run(specs[kind], made)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    assert made.read_bytes() == expected.read_bytes()


def test_reads_a_file(specs, tmp_path):
    spec, output = tmp_path / "spec.json", tmp_path / "meridian.mesh"
    spec.write_text(json.dumps(specs["meridian"]))
    assert program.main([str(spec), str(output)]) == 0
    assert output.exists()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("nonsense", "Expecting value"),
        ("", "Expecting value"),
        ("[1, 2]", "kind = None is refused"),
        ('{"kind": ["section"]}', "kind = ['section'] is refused"),
        (
            '{"kind": "sphere"}',
            "kind = 'sphere' is refused; allowed: cell, meridian, section, whole",
        ),
        ('{"kind": "whole"}', "keys = ['kind'] is refused; allowed: exactly ['kind', 'muscle']"),
        ('{"kind": "whole", "muscle": 3}', "muscle = 3 is refused"),
    ],
)
def test_nonsense_ends_with_a_message_and_status_2(text, message, tmp_path):
    done = run(None, tmp_path / "mesh", text)
    assert done.returncode == 2
    assert message in done.stderr
    assert len(done.stderr.splitlines()) == 1
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("path", "value", "message"),
    [
        (("muscle", "length"), -300, "length = -300 is refused; allowed: a finite number > 0 (mm)"),
        (("muscle", "length"), float("nan"), "length = nan is refused"),
        (("muscle", "lenght"), 300, "muscle.lenght = 300 is refused; allowed: no such key"),
        (("muscle", "braid", "threads"), 0, "threads = 0 is refused; allowed: an integer >= 1"),
        (("mesh", "rows"), [1, 1], "rows = (1, 1) is refused; allowed: three integers >= 1"),
        (("mesh", "finesse"), 2, "mesh.finesse = 2 is refused; allowed: no such key"),
        (("mesh",), 5, "mesh = 5 is refused; allowed: a mapping"),
        (("end",), "glued", "end = 'glued' is refused; allowed: one of clamp, butt, sliding"),
        (("ramp",), 1.0, "ramp = 1.0 is refused; allowed: none where the end is no clamp"),
        (("colour",), "red", "keys = ["),
    ],
)
def test_refusals_name_field_value_and_what_is_allowed(
    path, value, message, specs, tmp_path, capsys
):
    spec = json.loads(json.dumps(specs["section"]))
    place = spec
    for key in path[:-1]:
        place = place[key]
    place[path[-1]] = value
    source, output = tmp_path / "spec.json", tmp_path / "mesh"
    source.write_text(json.dumps(spec))
    assert program.main([str(source), str(output)]) == 2
    said = capsys.readouterr().err
    assert message in said
    assert len(said.splitlines()) == 1
    assert not output.exists()


@pytest.mark.parametrize("missing", ["source", "folder"])
def test_a_missing_file_or_folder_is_named(missing, specs, tmp_path, capsys):
    source, folder = tmp_path / "spec.json", tmp_path / "folder"
    if missing == "folder":
        source.write_text(json.dumps(specs["meridian"]))
    assert program.main([str(source), str(folder / "meridian.mesh")]) == 2
    assert str(source if missing == "source" else folder) in capsys.readouterr().err


def test_what_fails_leaves_the_old_file(tmp_path):
    """A file is whole or absent; one that was there stays until the new one is whole."""
    path = tmp_path / "mesh.msh"
    path.write_text("old")
    with pytest.raises(ZeroDivisionError), gmsh_file.writing(path, ".msh"):
        raise ZeroDivisionError
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


def test_meshing_is_what_imports_gmsh():
    """Importing it takes longer than most meshes do; who only describes a muscle does not wait."""
    modules = "geometry.muscle, geometry.section, geometry.meridian, geometry.whole"
    code = f"import sys, {modules}; sys.exit('gmsh' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], cwd=ROOT, check=False).returncode == 0
