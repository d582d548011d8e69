"""Results that are not as they were written are named, and only what may be wrong is read."""

import os
import time
from contextlib import suppress
from pathlib import Path

import pytest

from geometry.files import atomic_write
from workflow.run import damage
from workflow.study.errors import StudyError


@pytest.fixture
def results(tmp_path, monkeypatch):
    """Two results, written as all are."""
    monkeypatch.chdir(tmp_path)
    for name in ("figures/a.svg", "b 1.2.csv"):
        with atomic_write(tmp_path / "results" / name) as beside:
            beside.write_text(f"content of {name}")
    return tmp_path / "results"


def test_nothing_is_wrong(results):
    assert damage.noticed() == {}
    assert damage.compared() == (2, {})


def test_another_size_is_noticed_without_reading(results, monkeypatch):
    (results / "b 1.2.csv").write_text("cut")
    monkeypatch.setattr(damage, "seal_of", None)
    assert damage.noticed() == {"results/b 1.2.csv": "of another size (3 bytes)"}


def test_missing_and_no_file(results):
    (results / "b 1.2.csv").unlink()
    (results / "figures/a.svg").unlink()
    os.mkfifo(results / "figures/a.svg")
    expected = {"results/b 1.2.csv": "missing", "results/figures/a.svg": "no file"}
    assert damage.noticed() == expected
    assert damage.compared() == (2, expected)


def test_a_change_of_the_same_size_is_found_by_reading(results, capsys):
    path = results / "b 1.2.csv"
    path.write_text(path.read_text().upper())
    assert damage.noticed() == {}
    assert not damage.report(delete=False)
    assert "results/b 1.2.csv: changed\n1 of 2 files" in capsys.readouterr().out
    assert path.exists()
    assert not damage.report(delete=True)
    assert damage.noticed() == {"results/b 1.2.csv": "missing"}


@pytest.mark.parametrize("seal", ["", "nonsense", "\0", "a b c"])
def test_a_damaged_seal_is_damage(results, seal):
    (results / "seals/b 1.2.csv").write_text(seal)
    assert list(damage.noticed()) == ["results/b 1.2.csv"]


def test_a_process_that_is_killed_leaves_no_file_that_seems_whole(results, monkeypatch):
    """Between the seal and the file."""
    replace = os.replace

    def killed(beside, path):
        if "seals" not in str(path):
            raise KeyboardInterrupt
        replace(beside, path)

    monkeypatch.setattr(os, "replace", killed)
    with suppress(KeyboardInterrupt), atomic_write(results / "b 1.2.csv") as beside:
        beside.write_text("longer than the content before")
    assert list(damage.noticed()) == ["results/b 1.2.csv"]


def test_files_elsewhere_have_no_seal(results, tmp_path):
    with atomic_write(tmp_path / "mine.csv") as beside:
        beside.write_text("mine")
    assert damage.compared()[0] == 2


def test_no_seals_are_no_proof(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(StudyError, match="no seals"):
        damage.report(delete=False)


def test_what_is_dated_tomorrow_is_dated_now(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    tomorrow = time.time() + 86400
    files = [Path("results", name) for name in ("dataset.nc", "tables/a.csv", "cases/a.h5")]
    for path in files:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.touch()
        os.utime(path, (tomorrow, tomorrow))
    (Path("results") / "broken").symlink_to("nowhere")
    damage.end_future(Path("results"))
    assert [path.stat().st_mtime > time.time() for path in files] == [False, False, True]
