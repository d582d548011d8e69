"""Three muscles of other kinds, entered as the first steps say, and what is asked of each.

A thin one of silicone and one of latex in sleeves, the second with a gap, a large one of NBR:
force, threshold, free contraction, what 5 kg do, how near threads and rubber are to their limits.
"""

import pytest

from workflow import answers
from workflow.study.study import load

STUDY = """\
materials:
  silicone: {c10: 0.028, c01: 0.018, stretch_limit: 4}
  latex: {c10: 0.2, c01: 0.02, stretch_limit: 1.9}
  nbr: {c10: 0.345083, c01: 0.083805, stretch_limit: 3}
muscles:
  thin:
    {inner_diameter: 2.0, wall_thickness: 0.4, length: 150, material: silicone, thread_strength: 3,
    layers: [{kind: sleeve, threads: 24, angle: 18, thread_stiffness: 60}]}
  latex:
    {inner_diameter: 9.5, wall_thickness: 1.6, length: 200, material: latex, thread_strength: 20,
    layers: [{kind: sleeve, gap: 1, threads: 30, angle: 30, thread_stiffness: 300}]}
  large:
    {inner_diameter: 40, wall_thickness: 3, length: 500, material: nbr, layer_depths: [1, 1.5],
    threads: 100, angle: 25, thread_stiffness: 3600, thread_strength: 30}
scenes:
  curves: {path: isobaric, muscles: [thin, latex, large], pressure: 0.3, contraction: [0, 0.1],
    models: [membrane]}
"""
# Highest pressure; by the membrane force at it and 10 %, threshold at 10 %; by the cylinder free
# contraction, and under 5 kg.
KNOWN = {
    "thin": (0.5, 33.93, 0.03062, 0.37270, 0.014433),
    "latex": (0.4, 122.8, 0.1405, 0.24140, 0.18611),
    "large": (0.6, 3491.0, 0.1026, 0.30139, 0.29847),
}
NEAR = {"thin": 0.04, "latex": 0.08, "large": 0.06}  # the cylinder, of the largest force


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    path = tmp_path_factory.mktemp("three") / "hand.yaml"
    path.write_text(STUDY)
    return load(path)


@pytest.fixture
def ask(study, tmp_path_factory, monkeypatch):
    monkeypatch.chdir(tmp_path_factory.getbasetemp())
    return lambda muscle, **given: answers.ask(muscle, study=study, **given)


@pytest.mark.parametrize("muscle", KNOWN)
def test_what_is_asked_of_a_muscle(ask, muscle):
    pressure, force, threshold, free, lifted = KNOWN[muscle]
    found = ask(muscle, pressure=pressure, contraction=0.1)
    assert found.force == pytest.approx(force, rel=1e-3)
    other = ask(muscle, pressure=pressure, contraction=0.1, model="cylinder")
    blocked = ask(muscle, pressure=pressure, contraction=0.0, model="cylinder").force
    assert other.force == pytest.approx(found.force, abs=NEAR[muscle] * blocked)

    starts = ask(muscle, contraction=0.1, force=0.0)
    assert starts.pressure == pytest.approx(threshold, rel=1e-3)
    assert abs(starts.force) < 1e-5 * blocked

    ends = ask(muscle, pressure=pressure, force=0.0, model="cylinder")
    assert ends.contraction == pytest.approx(free, rel=1e-3)

    hanging = ask(muscle, pressure=pressure, force="5 kg", model="cylinder")
    assert hanging.contraction == pytest.approx(lifted, rel=2e-3)
    assert hanging.stroke == pytest.approx(lifted * hanging.length / (1 - lifted), rel=2e-3)


def test_limits_of_threads_and_rubber(ask):
    """Shares of what they bear, and a word where that is too little."""
    found = ask("thin", pressure=0.5, contraction=0.1)
    assert found.thread_share == pytest.approx(found.thread_force / 3)
    assert found.rubber_stretch == pytest.approx(2.28, rel=0.01)
    assert not [note for note in found.notes if "guess" not in note]  # of its error alone
    found = ask("large", pressure=0.6, contraction=0.1)
    assert found.thread_share > 1
    assert any("thread" in note for note in found.notes)
    found = ask("latex", pressure=0.4, force="5 kg")
    assert found.rubber_stretch > 1.9
    assert any("rubber" in note for note in found.notes)
