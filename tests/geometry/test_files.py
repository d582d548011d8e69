"""Files are whole or absent, whatever happens meanwhile."""

import os
from contextlib import suppress
from pathlib import Path

from geometry.files import atomic_write

ROOT = Path(__file__).parents[2]


def test_a_block_that_ends_well_leaves_the_file_alone(tmp_path):
    path = tmp_path / "folder" / "file.txt"
    with atomic_write(path) as beside:
        beside.write_text("content")
        assert not path.exists()
    assert path.read_text() == "content"
    assert list(path.parent.iterdir()) == [path]


def test_a_block_that_fails_leaves_what_was_there(tmp_path):
    path = tmp_path / "file.txt"
    path.write_text("old")
    with suppress(KeyboardInterrupt), atomic_write(path) as beside:
        beside.write_text("half")
        raise KeyboardInterrupt
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


def test_content_is_on_the_disk_before_the_name(tmp_path, monkeypatch):
    done = []
    for name in ("fsync", "replace"):
        real = getattr(os, name)
        monkeypatch.setattr(os, name, lambda *a, n=name, f=real: (done.append(n), f(*a))[1])
    with atomic_write(tmp_path / "file.txt") as beside:
        beside.write_text("content")
    assert done == ["fsync", "replace"]


def test_what_is_not_sealed_has_no_seal(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for name, sealed in (("a.csv", True), ("cost.json", False)):
        with atomic_write(Path("results", name), sealed=sealed) as beside:
            beside.write_text(name)
    assert [path.name for path in Path("results/seals").iterdir()] == ["a.csv"]


def test_files_are_renamed_in_one_place():
    renaming = [
        str(path.relative_to(ROOT))
        for package in ("geometry", "solver", "workflow")
        for path in (ROOT / package).rglob("*.py")
        if "os.replace(" in path.read_text() or "os.rename(" in path.read_text()
    ]
    assert renaming == ["geometry/files.py"]
