"""Parts as plain values are as dataclasses makes them."""

from dataclasses import asdict

import pytest

from geometry.plain import plain
from solver.load_path import LoadPath


@pytest.mark.parametrize("part", ["muscle", "bare_tube", "nbr", "thread"])
def test_as_dataclasses_would(request, part):
    found = plain(request.getfixturevalue(part))
    assert found == asdict(request.getfixturevalue(part))


def test_a_path_and_its_numerics(make_case):
    case = make_case(path=LoadPath(kind="isometric", held=0.1, stops=(0.1, 0.2)))
    assert plain(case.path) == asdict(case.path)
    assert plain(case.numerics) == asdict(case.numerics)


def test_what_is_made_can_be_changed(muscle):
    plain(muscle)["braid"]["threads"] = 1
    assert muscle.braid.threads == 60
