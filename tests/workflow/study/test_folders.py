"""Two studies never share a folder of tables and figures."""

from pathlib import Path

import pytest

from workflow.study import folders
from workflow.study.errors import StudyError


@pytest.fixture(autouse=True)
def here(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def study(file):
    """Write it; its path."""
    path = Path(file)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text("scenes: {}\n")
    return file


@pytest.mark.parametrize(
    ("file", "folder"),
    [
        ("config/config.yaml", "results"),
        ("./config/../config/config.yaml", "results"),
        ("grippers.yaml", "results/studies/grippers"),
        ("a/b/grippers.yaml", "results/studies/grippers"),
        ("config/smoke/study.yaml", "results/studies/smoke"),
        ("hand/config.yaml", "results/studies/hand"),
    ],
)
def test_a_folder_is_called_like_its_study(file, folder):
    assert str(folders.of_study(file)) == folder


def test_a_study_in_the_folder_of_the_run_is_called_like_that(here):
    assert folders.of_study("study.yaml").name == here.name


def test_two_files_of_one_name_are_refused():
    first, second = study("a/hand.yaml"), study("b/hand.yaml")
    folders.check_owner(first)
    folders.take(first)
    folders.check_owner(first)
    folders.check_owner(f"./{first}")
    with pytest.raises(StudyError, match=r"holds the results of a/hand\.yaml") as refused:
        folders.check_owner(second)
    assert "--directory" in str(refused.value)
    Path(first).unlink()  # moved
    folders.check_owner(second)


def test_the_default_study_leaves_no_mark():
    study("config/config.yaml")
    folders.take("config/config.yaml")
    assert not Path("results").exists()
