"""What leaving out an effect changes on a curve, by made-up records: what is compared, and how."""

from dataclasses import replace

import numpy as np
import pytest

from solver.effects import Effects
from solver.load_path import LoadPath
from solver.record import unreached
from solver.status import StateStatus
from workflow.plan.effect_costs import MESHES
from workflow.plan.worth import effects_of, measured

from ..synthetic import converged

STOPS = (0.0, 0.1, 0.2)
FORCE = {0.0: 600.0, 0.1: 300.0, 0.2: 50.0}


@pytest.fixture
def curve(make_case):
    """The same curve by any model; keywords are fields of the case to change."""
    path = LoadPath(kind="isobaric", held=0.3, stops=STOPS)
    return lambda model, **changes: make_case(**{"model": model, "path": path} | changes)


class Store:
    """Records that are off by known shares of the largest force at one stop; by key."""

    def __init__(self):
        self.records = {}

    def add(self, case, off=0.0, at=0.1, lost=()):
        stops = case.path.stops
        force = np.array([FORCE[stop] + (600 * off if stop == at else 0) for stop in stops])
        status = [StateStatus.CONVERGED] * len(stops)
        for stop in lost:
            status[stops.index(stop)] = StateStatus.INVALID_STATE
        found = converged(unreached(len(stops)) | {"force": force}, state_status=status)
        self.records[case.key] = case, found
        return case

    def known(self, key):
        return self.records.get(key)

    def said(self, *cases, more=()):
        return measured(cases, self.known, ["follows"], more)


@pytest.fixture
def store():
    return Store()


def test_of_no_records_nothing_is_said(curve, store):
    assert store.said(curve("solid"), curve("membrane")) == {}


def test_two_models_that_differ_by_one_effect(curve, store):
    membrane, cylinder = store.add(curve("membrane")), store.add(curve("cylinder"), off=0.04)
    (found,) = store.said(membrane, cylinder).values()
    assert found.effects == ("end_caps",)
    assert found.change == pytest.approx(0.04)
    assert (found.by, found.lost) == (("membrane", "cylinder"), 0)


def test_a_record_that_no_scene_asks_for_tells_it_too(curve, store):
    store.add(curve("cylinder"), off=0.04)
    assert set(store.said(store.add(curve("membrane")))) == {"end_caps"}


def test_two_effects_are_known_together(curve, store):
    solid, membrane = store.add(curve("solid")), store.add(curve("membrane"), off=0.01, lost=[0.2])
    found = store.said(solid, membrane)
    assert set(found) == {"cap_geometry", "compressibility"}
    assert all(set(each.effects) == set(found) for each in found.values())
    assert {each.lost for each in found.values()} == {1}
    store.add(curve("solid", effects=Effects(volume="incompressible")), off=0.001)
    found = store.said(solid, membrane)
    assert found["compressibility"].effects == ("compressibility",)
    assert found["compressibility"].change == pytest.approx(0.001)


def test_of_two_that_tell_it_the_fuller_model_does(curve, store):
    for model, off in (("membrane", 0.03), ("cylinder", 0.05)):
        store.add(curve(model))
        store.add(curve(model, effects=Effects(wall="one_radius")), off=off)
    found = store.said(curve("cylinder"))["wall_thickness"]
    assert found.by == ("membrane", "membrane")
    assert found.change == pytest.approx(0.03)


def test_what_a_mesh_changes_is_no_effect(curve, store):
    coarser = replace(curve("solid").numerics, **MESHES["coarser"])
    store.add(curve("solid"))
    store.add(curve("solid", numerics=coarser), off=0.01)
    off = Effects(volume="incompressible")
    without = store.add(curve("solid", numerics=coarser, effects=off), off=0.011)
    found = store.said(curve("solid"), curve("solid", numerics=coarser), without)
    assert set(found) == {"compressibility"}
    assert found["compressibility"].change == pytest.approx(0.001, rel=0.02)


def test_ends_that_are_held_otherwise_are_another_curve(curve, store):
    solid = store.add(curve("solid", effects=Effects(end="butt")))
    store.add(curve("solid", effects=Effects(threads="two_way")), off=0.01)
    assert store.said(solid) == {}


def test_records_at_some_of_the_stops_tell_of_these(curve, store):
    membrane = store.add(curve("membrane"), off=0.02, at=0.2)
    few = LoadPath(kind="isobaric", held=0.3, stops=(0.0, 0.2))
    solid = store.add(curve("solid", path=few))
    assert store.said(membrane) == {}
    found = store.said(membrane, more=[solid.key])
    assert found["cap_geometry"].change == pytest.approx(0.02)
    other = LoadPath(kind="isobaric", held=0.3, stops=(0.1,))
    assert store.said(membrane, more=[store.add(curve("solid", path=other)).key]) != {}


def test_a_bare_tube_has_no_effects_of_a_braid(make_case, bare_tube):
    assert "thread_stretch" in effects_of(make_case())
    of_tube = effects_of(make_case(model="solid", muscle=bare_tube))
    assert not {"thread_stretch", "slackening", "discrete_threads"} & set(of_tube)
    assert "rubber" in of_tube
