"""The thread law in Python and in FreeFEM: the same numbers, and what they must be."""

from pathlib import Path

import numpy as np
import pytest

from solver import freefem
from solver.effects import ThreadLaw
from solver.threads import thread_law

PROGRAM = Path(__file__).parent / "edp" / "thread_law.edp"
THREADS = Path(thread_law.__file__).parent
STRETCHES = np.concatenate([np.linspace(0.7, 1.5, 41), 1 + np.linspace(-5e-3, 5e-3, 41)])
WIDTHS = [1e-3, 2e-5]
TENSION_ONLY, TWO_WAY = ThreadLaw.TENSION_ONLY, ThreadLaw.TWO_WAY


@pytest.fixture
def in_freefem(tmp_path):
    """Columns of law.csv."""

    def run(law: ThreadLaw, width: float) -> dict[str, np.ndarray]:
        (tmp_path / "composition.idp").write_text(f'include "threads_{law}.idp"\n')
        numbers = " ".join(repr(float(s)) for s in STRETCHES)
        (tmp_path / "stretches.txt").write_text(f"{len(STRETCHES)} {numbers}\n")
        limits = freefem.Limits(wall_time=30, memory=2000)
        folders = [freefem.PATH, THREADS]
        given = {"slack_width": width}
        freefem.run(PROGRAM, given, tmp_path, tmp_path / "log", limits, folders)
        table = np.genfromtxt(tmp_path / "law.csv", delimiter=",", names=True)
        return {name: table[name] for name in table.dtype.names}

    return run


@pytest.mark.parametrize("width", WIDTHS)
@pytest.mark.parametrize("law", ThreadLaw)
def test_both_languages_agree(in_freefem, law, width):
    found = in_freefem(law, width)
    np.testing.assert_array_equal(found["stretch"], STRETCHES)
    for name, function in (("tension", thread_law.tension), ("energy", thread_law.energy)):
        expected = function(law, width, STRETCHES)
        np.testing.assert_allclose(found[name], expected, rtol=1e-12, atol=1e-17, err_msg=name)


@pytest.mark.parametrize("width", WIDTHS)
@pytest.mark.parametrize("law", ThreadLaw)
def test_modulus_is_the_derivative_of_the_tension(in_freefem, law, width):
    h = width / 100
    differences = (
        thread_law.tension(law, width, STRETCHES + h)
        - thread_law.tension(law, width, STRETCHES - h)
    ) / (2 * h)
    np.testing.assert_allclose(in_freefem(law, width)["modulus"], differences, atol=1e-4)


@pytest.mark.parametrize("width", WIDTHS)
@pytest.mark.parametrize("law", ThreadLaw)
def test_tension_is_the_derivative_of_the_energy(law, width):
    h = width / 100
    differences = (
        thread_law.energy(law, width, STRETCHES + h) - thread_law.energy(law, width, STRETCHES - h)
    ) / (2 * h)
    tension = thread_law.tension(law, width, STRETCHES)
    np.testing.assert_allclose(differences, tension, rtol=1e-4, atol=1e-4 * width)


def test_two_way_threads_are_linear():
    assert thread_law.tension(TWO_WAY, 1e-3, np.array([0.9, 1.0, 1.1])) == pytest.approx(
        [-0.1, 0, 0.1]
    )
    assert thread_law.energy(TWO_WAY, 1e-3, np.array([0.9, 1.1])) == pytest.approx([0.005, 0.005])


def test_taut_threads_are_linear_too():
    strain = np.array([0.05, 0.1, 0.3])
    tension = thread_law.tension(TENSION_ONLY, 1e-3, 1 + strain)
    np.testing.assert_allclose(tension, strain, rtol=2e-3)


def test_slack_threads_carry_next_to_nothing():
    strain = np.array([-0.05, -0.1, -0.3])
    tension = thread_law.tension(TENSION_ONLY, 1e-3, 1 + strain)
    assert np.all(np.abs(tension) < 1.1e-3 * np.abs(strain))


def test_a_thread_at_rest_is_not_quite_free():
    """The smooth law leaves a quarter of its width at strain 0."""
    assert thread_law.tension(TENSION_ONLY, 1e-3, np.array([1.0])) == pytest.approx([0.25e-3])
