"""What a batch solves: what has no right record, and nothing else."""

import json
import os
import random
from dataclasses import replace

import pytest

from geometry.files import SEALS
from solver import record
from solver.case import Case
from solver.freefem import Limits
from solver.load_path import LoadPath
from workflow.analyses.analysis import AnalysisCase
from workflow.run import batches, made, pool
from workflow.study.folders import CASES, COST, MESHES

LIMITS = Limits(wall_time=60, memory=4000)


@pytest.fixture
def cases(make_case, tmp_path, monkeypatch):
    """Three cases that take no time, and one with a mesh, in a folder without results."""
    monkeypatch.chdir(tmp_path)
    paths = [LoadPath(kind="isobaric", held=p, stops=(0.0, 0.1)) for p in (0.1, 0.2, 0.3)]
    made = [make_case(model="geometric", path=path) for path in paths]
    made.append(make_case(model="membrane", path=LoadPath(kind="isobaric", held=0.3, stops=(0.1,))))
    return {case.key: AnalysisCase(case, f"the {case.model}") for case in made}


def solve(cases, tmp_path, cores=2):
    """How many were lost, and the words of the log by name."""
    lost = batches.solve(cases, cores, LIMITS, tmp_path / "logs/batch.log")
    lines = (tmp_path / "logs/batch.log").read_text().splitlines()
    return lost, {line.split()[2]: line.split()[1] for line in lines}


def keys_of(cases, model):
    return [key for key, asked in cases.items() if asked.case.model == model]


def test_what_is_right_is_not_solved_again(cases, tmp_path):
    lost, words = solve(cases, tmp_path)
    assert lost == 0
    assert [words[key] for key in cases] == ["converged"] * 4
    assert list(words.values()).count("meshed") == 1
    before = {path: path.read_bytes() for path in CASES.iterdir()}
    stamp = batches.stamp(cases)
    assert solve(cases, tmp_path) == (0, {})
    (first, _, _), (membrane,) = keys_of(cases, "geometric"), keys_of(cases, "membrane")
    (CASES / f"{first}.h5").unlink()
    assert list(solve(cases, tmp_path)[1]) == [first]
    with (CASES / f"{membrane}.h5").open("r+b") as file:
        file.seek(3000)
        file.write(b"flipped")
    assert batches.to_solve(cases) == {membrane: "no readable record"}
    assert list(solve(cases, tmp_path)[1]) == [membrane]
    next(MESHES.iterdir()).unlink()
    assert list(solve(cases, tmp_path)[1].values()) == ["meshed"]
    assert {path: path.read_bytes() for path in CASES.iterdir()} == before
    assert batches.stamp(cases) == stamp
    assert {path.stem for path in (SEALS / "cases").iterdir()} == set(cases)


def test_a_record_of_other_sources_is_solved_again(cases, tmp_path):
    solve(cases, tmp_path)
    key = keys_of(cases, "geometric")[0]
    case, solution = record.read(CASES / f"{key}.h5")
    record.write(CASES / f"{key}.h5", case, replace(solution, code="0" * 16))
    assert batches.to_solve(cases) == {key: "its sources have changed"}
    assert list(solve(cases, tmp_path)[1]) == [key]


def test_what_another_job_has_made_meanwhile_stays(cases, tmp_path, monkeypatch):
    """Two jobs of a cluster share meshes; each has looked what is missing before the other ends."""
    run, between = pool.run, []

    def after_the_other(*arguments):
        monkeypatch.setattr(pool, "run", run)
        (tmp_path / "other").mkdir()
        assert solve(cases, tmp_path / "other")[0] == 0
        between.extend(MESHES.iterdir())
        between.append(between[0].stat())
        return run(*arguments)

    monkeypatch.setattr(pool, "run", after_the_other)
    assert solve(cases, tmp_path)[0] == 0
    mesh, before = between
    assert mesh.stat() == before


def test_a_case_without_its_mesh_is_not_solved(cases, tmp_path, monkeypatch, capfd):
    """The mesh of before is none, though a file is there."""
    solve(cases, tmp_path)
    (key,), (mesh,) = keys_of(cases, "membrane"), MESHES.iterdir()
    made.note(mesh, "0" * 16)
    (CASES / f"{key}.h5").unlink()
    monkeypatch.setattr(batches, "make", lambda spec, path: os.kill(os.getpid(), 9))
    assert solve(cases, tmp_path) == (1, {mesh.name: "not_solved", key: "not_solved"})
    assert "there is no mesh (the membrane)" in capfd.readouterr().err


def test_a_folder_in_the_place_of_a_result_gives_way(cases, tmp_path):
    (key,) = keys_of(cases, "membrane")
    (CASES / f"{key}.h5" / "inner").mkdir(parents=True)
    assert solve(cases, tmp_path)[0] == 0
    assert (CASES / f"{key}.h5").is_file()


def test_a_case_that_is_killed_or_broken_loses_itself_only(cases, tmp_path, monkeypatch, capfd):
    run = batches.Job.run
    first, second, _ = keys_of(cases, "geometric")

    def flawed(job, start, used):
        if job.case.key == first:
            os.kill(os.getpid(), 9)
        if job.case.key == second:
            raise MemoryError
        return run(job, start, used)

    monkeypatch.setattr(batches.Job, "run", flawed)
    lost, words = solve(cases, tmp_path)
    assert lost == 2
    assert [key for key in cases if words[key] == "not_solved"] == [first, second]
    assert "its process was ended by SIGKILL (the geometric)" in capfd.readouterr().err
    assert {path.stem for path in CASES.iterdir()} == set(cases) - {first, second}
    monkeypatch.setattr(batches.Job, "run", run)
    lost, words = solve(cases, tmp_path)
    assert (lost, set(words)) == (0, {first, second})


def test_no_stale_record_is_left_by_what_is_tried_in_vain(cases, tmp_path, monkeypatch):
    solve(cases, tmp_path)
    key = keys_of(cases, "geometric")[0]
    case, solution = record.read(CASES / f"{key}.h5")
    record.write(CASES / f"{key}.h5", case, replace(solution, code="0" * 16))
    monkeypatch.setattr(batches.Job, "run", lambda job, start, used: "the disk is full")
    assert solve(cases, tmp_path)[0] == 1
    assert not (CASES / f"{key}.h5").exists()


def test_a_mesh_that_cannot_be_made_is_a_result(cases, tmp_path, monkeypatch):
    def refuse(spec, path):
        raise ValueError("no such mesh")

    monkeypatch.setattr(batches, "make", refuse)
    lost, words = solve(cases, tmp_path)
    (key,) = keys_of(cases, "membrane")
    assert (lost, words[key]) == (0, "mesh_failed")
    assert "no such mesh" in record.read(CASES / f"{key}.h5")[1].reason


def test_the_record_is_that_of_the_case_alone(cases, tmp_path):
    """Solved as ``python -m solver`` does: from the canonical text."""
    solve(cases, tmp_path)
    for key in cases:
        case, _ = record.read(CASES / f"{key}.h5")
        assert Case.from_json(cases[key].case.canonical()) == case
        assert json.loads((COST / f"{key}.json").read_text())["status"] == "converged"


def test_a_case_that_is_added_touches_one_batch(cases):
    """And moves no other one; batches are of about equal size."""
    chance = random.Random(1)
    keys = [f"{chance.getrandbits(64):016x}" for _ in range(2000)]
    found = dict.fromkeys(keys)
    before = [set(batches.of_batch(found, number, 20)) for number in range(20)]
    assert sorted(key for batch in before for key in batch) == sorted(keys)
    assert min(map(len, before)) > 60
    added = found | {"0123456789abcdef": None}
    after = [set(batches.of_batch(added, number, 20)) for number in range(20)]
    assert sum(one != other for one, other in zip(before, after, strict=True)) == 1
    assert batches.numbers(keys[:1], 20) == [int(keys[0], 16) % 20]
    assert batches.wanted(cases) != batches.wanted(dict(list(cases.items())[1:]))
    assert batches.wanted(cases) == batches.wanted(dict(reversed(cases.items())))
