"""The fit of a memory: made-up loops and relaxations give it back; what is read, and refused."""

import argparse
from pathlib import Path

import numpy as np
import pytest

from solver.history import History, Wave, sampled
from solver.load_path import LoadPath
from solver.memory import Memory
from workflow.answers import memory_fit
from workflow.programs import fit_memory
from workflow.study.errors import StudyError
from workflow.study.study import load

CONFIG = Path(__file__).parents[3] / "config" / "config.yaml"


@pytest.fixture(scope="module")
def study():
    return load(CONFIG)


def rows_of(study, solve_case, times, stops, share, to):
    """A file as a bench writes it: with noise, and an elastic force that is off."""
    path = LoadPath(kind="isobaric", held=0.3, stops=stops, history=History(times=times))
    memory = Memory.flat(share, 0.1, to)
    states = solve_case(study.muscles["dmsp20"].case(path, "cylinder", memory=memory)).states
    noise = 0.3 * np.random.default_rng(4).normal(size=len(times))
    e = np.array(stops)
    force = (states["force"] + noise + 15 - 80 * e + 600 * e**2).tolist()
    rows = zip(times, stops, force, strict=True)
    return "\n".join(f"{t!r},3,{100 * e:.8g},{f!r}" for t, e, f in rows)


HEADER = "time [s],pressure [bar],contraction [%],force [N]\n"


def test_a_loop_gives_its_memory_back(study, solve_case, tmp_path, capsys, monkeypatch):
    times, stops = sampled(Wave.TRIANGLE, 0.02, 0.15, 2.0, 2, 20)
    file = tmp_path / "loop.csv"
    file.write_text(HEADER + rows_of(study, solve_case, times, stops, 0.08, 10.0))
    monkeypatch.chdir(tmp_path)
    parser = argparse.ArgumentParser()
    fit_memory.add_arguments(parser)
    options = ["--muscle", "dmsp20", "--model", "cylinder", "--study", str(CONFIG)]
    assert fit_memory.run(parser.parse_args([str(file), *options])) == 0
    said = capsys.readouterr().out
    assert "from: 0.1, to: 10" in said
    share, interval = (float(said.split(word)[1].split()[0]) for word in ("relaxation of ", "+- "))
    assert 0.0002 < interval < 0.003
    assert abs(share - 0.08) < 2 * interval
    assert Path("dmsp20_memory.png").stat().st_size > 10_000


def test_a_relaxation_does(study, solve_case, tmp_path):
    times = (0.0, *np.geomspace(0.1, 100, 31).tolist())
    stops = (0.0, *[0.1] * 31)
    file = tmp_path / "relaxation.csv"
    file.write_text(HEADER + rows_of(study, solve_case, times, stops, 0.08, 100.0))
    found = memory_fit.fit(study, "dmsp20", str(file), tmp_path, model="cylinder")
    assert found.per_decade == pytest.approx(0.08, abs=2 * found.interval + 0.004)
    assert found.residual < 0.6


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (HEADER.replace("time [s]", "n"), "the column time is missing"),
        (HEADER + "0,3,0,100\n0,3,1,90\n" + "2,3,1,80\n" * 9, ":3: .*not rise.* 0 s stands here"),
        (HEADER + "0,3,0,100\n,3,1,90\n" + "2,3,1,80\n" * 9, ":3: .* no time stands here after 0"),
        (HEADER + "".join(f"{k},3,{k},{100 - k}\n" for k in range(4)), "at least 8"),
        (HEADER + "".join(f"{0.4 * k},3,{k},{100 - k}\n" for k in range(8)), "a decade of times"),
        (HEADER + "".join(f"{k},3,5,{100 - k}\n" for k in range(20)), "--start unloaded"),
    ],
    ids=["no time", "not rising", "a gap", "few", "short", "at rest"],
)
def test_what_is_refused(study, tmp_path, text, said):
    file = tmp_path / "loop.csv"
    if text.count("\n") == 1:
        text += "".join(f"{k},3,{k},{100 - k}\n" for k in range(9))
    file.write_text(text)
    with pytest.raises(StudyError, match=said):
        memory_fit.fit(study, "dmsp20", str(file), tmp_path, model="cylinder")


def test_a_model_without_time(study, tmp_path):
    with pytest.raises(StudyError, match="cylinder, membrane, solid"):
        memory_fit.fit(study, "dmsp20", "none.csv", tmp_path, model="cell")
