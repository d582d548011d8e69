"""The identity of a case: what changes its key, what does not, and what makes no sense."""

import json
import math

import pytest

from geometry.muscle import Muscle
from geometry.refusal import Refusal
from solver.case import Case
from solver.effects import CHOICES, Effects
from solver.load_path import LoadPath
from solver.memory import Memory
from solver.models import MODELS as DESCRIPTORS
from solver.refusal import UnsolvableCase
from solver.rubber.mooney_rivlin.law import MooneyRivlin

MODELS = tuple(DESCRIPTORS)
MESHED = ("membrane", "solid", "cell")
BUILT = ("cylinder", *MESHED)

# Every number and switch of a case, a changed value, and the models that read it.
FACTORS = {
    "muscle.inner_diameter": (20.1, MODELS),
    "muscle.wall_thickness": (2.5, BUILT),
    "muscle.length": (200.0, ("cylinder", *MESHED)),
    "muscle.cap_length": (9.0, ("solid",)),
    "muscle.braid.lead": (216.0, MODELS),
    "muscle.braid.threads": (120, MODELS),  # a braid is kept whole, also for Eq. (1)
    "muscle.braid.layer_diameters": ((20.6, 21.9), MODELS),
    "rubber.c10": (0.4, BUILT),
    "rubber.c01": (0.1, BUILT),
    "rubber.kappa": (2000.0, ("solid", "cell")),
    "thread.stiffness": (600.0, BUILT),
    "path.kind": ("isometric", MODELS),
    "path.held": (0.2, MODELS),
    "path.stops": ((0.0, 0.2), MODELS),
    "path.zero_force": (True, MODELS),
    "effects.end": ("sliding", ("solid",)),
    "effects.threads": ("two_way", BUILT),
    "effects.layers": ("smeared", ("cell",)),
    "effects.twist": ("free", ("cylinder", "cell")),
    "effects.wall": ("one_radius", ("cylinder", "membrane")),
    "effects.stretch": ("rigid", ("cylinder",)),
    "effects.volume": ("incompressible", ("solid",)),
    "effects.rubber": ("none", ("cylinder",)),
    "fields_at": ((0.1,), MESHED),
    "memory": (Memory.flat(0.06, 1e-3, 1e3), ()),  # out of time nothing relaxes
    "numerics.newton.tolerance": (1e-8, MESHED),
    "numerics.newton.iterations": (20, MESHED),
    "numerics.newton.smallest_step": (1e-4, MESHED),
    "numerics.meridian.cap_step": (0.4, ("membrane",)),
    "numerics.meridian.growth": (1.3, ("membrane",)),
    "numerics.meridian.body_step": (0.9, ("membrane",)),
    "numerics.meridian.refinement": (2, ("membrane",)),
    "numerics.section.cap_step": (0.4, ("solid",)),
    "numerics.section.growth": (1.3, ("solid",)),
    "numerics.section.body_step": (0.9, ("solid",)),
    "numerics.section.refinement": (2, ("solid",)),
    "numerics.section.rows": ((1, 1, 2), ("solid",)),
    "numerics.clamp.ramp": (3.0, ("solid",)),
    "numerics.clamp.thread_stiffness": (100.0, ("solid",)),
    "numerics.clamp.inner_stiffness": (10.0, ("solid",)),
    "numerics.slack.width": (2e-3, BUILT),
    "numerics.slack.stiffness": (100.0, BUILT),
    "numerics.cell.thread_size": (0.9, ("cell",)),
    "numerics.cell.body_size": (0.2, ("cell",)),
    "numerics.cell.growth": (0.4, ("cell",)),
    "numerics.cell.refinement": (2, ("cell",)),
    "numerics.cell.repeats": (2, ("cell",)),
    "numerics.spread.radius": (0.6, ("cell",)),
    "numerics.spread.modulus": (2000.0, ("cell",)),
}


def full(case: Case) -> dict:
    """Every setting, also those that the model does not read."""
    return {
        "muscle": case.muscle,
        "rubber": case.rubber,
        "thread": case.thread,
        "path": case.path,
        "model": case.model,
        "effects": case.effects,
        "numerics": case.numerics,
        "fields_at": case.fields_at,
    }


def changed(thing, names: list[str], value):
    """A copy of nested frozen dataclasses with one field changed."""
    name, *rest = names
    entries = {f: getattr(thing, f) for f in thing.__dataclass_fields__}
    entries[name] = changed(entries[name], rest, value) if rest else value
    return type(thing)(**entries)


def every_field(thing, name: str = "") -> set[str]:
    """Dotted names of all fields that are no dataclass themselves."""
    found = set()
    for f in thing.__dataclass_fields__:
        value, dotted = getattr(thing, f), f"{name}.{f}" if name else f
        found |= every_field(value, dotted) if hasattr(value, "__dataclass_fields__") else {dotted}
    return found


@pytest.fixture
def curve(make_case):
    """A case with two stops, by model."""
    path = LoadPath(kind="isobaric", held=0.3, stops=(0.0, 0.1))
    return lambda model: make_case(model=model, path=path)


def test_the_table_of_factors_is_complete(curve):
    others = {"model", "path.history", "frequencies", "friction"}  # have tests of their own
    assert every_field(curve("solid")) - others == set(FACTORS)


@pytest.mark.parametrize("factor", FACTORS)
@pytest.mark.parametrize("model", MODELS)
def test_key_changes_with_what_the_model_reads(curve, model, factor):
    value, readers = FACTORS[factor]
    if factor == "fields_at" and model not in MESHED:
        with pytest.raises(UnsolvableCase, match="no fields"):
            changed(curve(model), [factor], value)
        return
    refused = factor.startswith("effects.") and factor.removeprefix("effects.") not in CHOICES
    if refused and model not in readers:
        with pytest.raises(UnsolvableCase, match=f"{value} with {', '.join(readers)}"):
            changed(curve(model), factor.split("."), value)
        return
    other = changed(curve(model), factor.split("."), value)
    if model in readers:
        assert other.key != curve(model).key
    else:
        assert other.canonical() == curve(model).canonical()


def test_models_do_not_share_keys(curve):
    assert len({curve(model).key for model in MODELS}) == len(MODELS)


@pytest.mark.parametrize("factor", ["muscle.cap_length", "numerics.clamp.ramp"])
def test_without_a_clamp_its_settings_do_not_matter(make_case, factor):
    butt = make_case(model="solid", effects=Effects(end="butt"))
    other = changed(butt, factor.split("."), FACTORS[factor][0])
    assert other.key == butt.key
    assert other.mesh_spec() == butt.mesh_spec()


@pytest.mark.parametrize("model", BUILT)
def test_two_way_threads_do_not_slacken(make_case, model):
    case = make_case(model=model, effects=Effects(threads="two_way"))
    assert changed(case, ["numerics", "slack", "width"], 1e-2).key == case.key


@pytest.mark.parametrize("model", BUILT)
def test_a_bare_tube_has_no_threads(make_case, bare_tube, model):
    bare = make_case(model=model, muscle=bare_tube)
    assert "thread" not in json.loads(bare.canonical())
    for factor in ("effects.threads", "effects.layers", "numerics.slack.width"):
        assert changed(bare, factor.split("."), FACTORS[factor][0]).key == bare.key


def test_what_an_effect_would_read_is_no_part_of_a_case_without_it(make_case):
    rigid = make_case(model="cylinder", effects=Effects(stretch="rigid"))
    for factor in ("thread.stiffness", "numerics.slack.width"):
        assert changed(rigid, factor.split("."), FACTORS[factor][0]).key == rigid.key
    net = make_case(model="cylinder", effects=Effects(rubber="none"))
    assert changed(net, ["rubber", "c10"], 0.4).key == net.key
    solid = make_case(model="solid", effects=Effects(volume="incompressible"))
    assert changed(solid, ["rubber", "kappa"], 2000.0).key == solid.key


# --- canonical JSON -------------------------------------------------------------------------------


def test_whole_numbers_are_one_number(make_case, muscle):
    whole = make_case(path=LoadPath(kind="isotonic", held=200, stops=(0, 1)))
    decimal = make_case(
        muscle=Muscle.from_dict({**muscle.as_dict(), "inner_diameter": 20.0, "length": 3e2}),
        path=LoadPath(kind="isotonic", held=200.0, stops=(-0.0, 1.0)),
    )
    assert whole.canonical() == decimal.canonical()


def test_decimals_are_the_shortest(make_case):
    text = make_case(path=LoadPath(kind="isobaric", held=0.30, stops=(0.07, 0.1))).canonical()
    assert '"held": 0.3' in text
    assert '"stops": [0.07, 0.1]' in text


def test_order_of_keys_does_not_matter(make_case):
    def backwards(value):
        if isinstance(value, dict):
            return {k: backwards(value[k]) for k in reversed(value)}
        return value

    case = make_case(model="solid")
    text = json.dumps(backwards(json.loads(case.canonical())))
    assert text != case.canonical()
    assert Case.from_json(text).canonical() == case.canonical()


def test_key_is_short_and_hexadecimal(make_case):
    assert len(make_case().key) == 16
    int(make_case().key, 16)


ROUND_TRIPS = {
    **{model: {"model": model} for model in MODELS},
    "membrane with fields": {"model": "membrane", "fields_at": (0.1,)},
    "solid with fields": {"model": "solid", "fields_at": (0.1,)},
    "solid butt": {"model": "solid", "effects": Effects(end="butt", threads="two_way")},
    "solid that keeps its volume": {
        "model": "solid",
        "effects": Effects(volume="incompressible"),
        "rubber": MooneyRivlin(c10=80, c01=20, kappa=1e5),
    },
    "rigid net": {"model": "cylinder", "effects": Effects(stretch="rigid")},
    "net alone": {"model": "cylinder", "effects": Effects(stretch="rigid", rubber="none")},
    "isotonic": {"path": LoadPath(kind="isotonic", held=200.0, stops=(0.1, 0.3))},
    "threshold": {"path": LoadPath(kind="isometric", held=0.1, stops=(0.3,), zero_force=True)},
    # stiffer than the default bulk modulus allows, which membrane and cylinder do not read
    "stiff membrane": {"rubber": MooneyRivlin(c10=80, c01=20, kappa=1e5)},
    "stiff cylinder": {"model": "cylinder", "rubber": MooneyRivlin(c10=80, c01=20, kappa=1e5)},
}


@pytest.mark.parametrize("name", ROUND_TRIPS)
def test_round_trip(make_case, name):
    case = make_case(**ROUND_TRIPS[name])
    again = Case.from_json(case.canonical())
    assert again.canonical() == case.canonical()
    assert again.key == case.key
    assert again.mesh_spec() == case.mesh_spec()


@pytest.mark.parametrize("model", BUILT)
def test_round_trip_of_a_bare_tube(make_case, bare_tube, model):
    case = make_case(model=model, muscle=bare_tube)
    assert Case.from_json(case.canonical()).canonical() == case.canonical()


# --- the mesh -------------------------------------------------------------------------------------

SHAPES_NO_MESH = [
    "rubber.c10",
    "path.held",
    "effects.threads",
    "numerics.newton.tolerance",
    "numerics.clamp.thread_stiffness",
]
SHAPES_NO_HALF_MUSCLE = ["muscle.braid.lead", "muscle.braid.threads", "thread.stiffness"]
SHAPES_NO_CELL = ["muscle.length", "effects.layers", "effects.twist"]


@pytest.mark.parametrize(
    ("model", "factor"),
    [
        *((model, factor) for model in MESHED for factor in SHAPES_NO_MESH),
        *((model, factor) for model in MESHED[:2] for factor in SHAPES_NO_HALF_MUSCLE),
        *(("cell", factor) for factor in SHAPES_NO_CELL),
        *((model, "numerics.clamp.ramp") for model in MESHED if model != "solid"),
    ],
)
def test_muscles_share_a_mesh(curve, model, factor):
    other = changed(curve(model), factor.split("."), FACTORS[factor][0])
    assert other.key != curve(model).key or model not in FACTORS[factor][1]
    assert other.mesh_spec() == curve(model).mesh_spec()


@pytest.mark.parametrize(
    ("model", "factor"),
    [
        ("membrane", "muscle.inner_diameter"),
        ("membrane", "muscle.length"),
        ("membrane", "numerics.meridian.refinement"),
        ("solid", "muscle.wall_thickness"),
        ("solid", "muscle.cap_length"),
        ("solid", "muscle.braid.layer_diameters"),
        ("solid", "effects.end"),
        ("solid", "numerics.section.rows"),
        ("solid", "numerics.clamp.ramp"),
        ("cell", "muscle.braid.lead"),
        ("cell", "muscle.braid.threads"),
        ("cell", "thread.stiffness"),
        ("cell", "numerics.cell.thread_size"),
    ],
)
def test_meshes_differ_where_they_must(curve, model, factor):
    other = changed(curve(model), factor.split("."), FACTORS[factor][0])
    assert other.mesh_spec() != curve(model).mesh_spec()


def test_models_without_a_mesh(curve):
    assert curve("geometric").mesh_spec() is None
    assert curve("cylinder").mesh_spec() is None


# --- refusals -------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("field", "changes"),
    [
        ("model", {"model": "shell"}),
        ("thread", {"thread": None}),
        ("fields_at", {"fields_at": (0.2,)}),
        ("fields_at", {"model": "cylinder", "fields_at": (0.1,)}),
    ],
)
def test_parts_that_do_not_fit(make_case, field, changes):
    with pytest.raises(UnsolvableCase) as refused:
        Case(**full(make_case()) | changes)
    assert refused.value.field == field


def test_eq_1_needs_a_braid(make_case, bare_tube):
    with pytest.raises(UnsolvableCase, match=r"Eq\. \(1\) needs a braid"):
        make_case(model="geometric", muscle=bare_tube)


BROKEN = {
    "unknown key": lambda v: v | {"numeric": {}},
    "unknown key of the muscle": lambda v: v | {"muscle": v["muscle"] | {"colour": "red"}},
    "unknown setting": lambda v: v | {"numerics": {"newtone": {}}},
    "unknown key of a setting": lambda v: v | {"numerics": {"newton": {"tol": 1e-9}}},
    "settings are a list": lambda v: v | {"numerics": []},
    "settings are a number": lambda v: v | {"numerics": 5},
    "no muscle": lambda v: {k: v[k] for k in v.keys() - {"muscle"}},
    "muscle is a word": lambda v: v | {"muscle": "dmsp20"},
    "muscle is nothing": lambda v: v | {"muscle": None},
    "braid is a number": lambda v: v | {"muscle": v["muscle"] | {"braid": 5}},
    "no braid": lambda v: v | {"muscle": {k: e for k, e in v["muscle"].items() if k != "braid"}},
    "no model": lambda v: {k: v[k] for k in v.keys() - {"model"}},
    "no path": lambda v: {k: v[k] for k in v.keys() - {"path"}},
    "path is a list": lambda v: v | {"path": [0.3]},
    "stops are a number": lambda v: v | {"path": v["path"] | {"stops": 0.1}},
    "stops are words": lambda v: v | {"path": v["path"] | {"stops": "0.1"}},
    "stop is a list": lambda v: v | {"path": v["path"] | {"stops": [[0.1]]}},
    "kind is a number": lambda v: v | {"path": v["path"] | {"kind": 3}},
    "rubber is nothing": lambda v: v | {"rubber": None},
    "modulus is a word": lambda v: v | {"rubber": {"c10": "0.3", "c01": 0}},
    "fields are a number": lambda v: v | {"fields_at": 5},
    "not a number": lambda v: v | {"path": v["path"] | {"held": math.nan}},
    "a list": lambda v: [v],
    "a word": lambda v: "solid",
    "nothing": lambda v: None,
}


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("name", BROKEN)
def test_nonsense_is_refused_in_words(make_case, model, name):
    values = BROKEN[name](json.loads(make_case(model=model).canonical()))
    with pytest.raises(Refusal) as refused:
        Case.from_json(json.dumps(values))
    assert "is refused; allowed: " in str(refused.value)


@pytest.mark.parametrize(
    ("model", "part", "key"),
    [
        ("cylinder", "muscle", "wall_thickness"),
        ("membrane", "muscle", "length"),
        ("membrane", "rubber", "c10"),
        ("solid", "thread", "stiffness"),
        ("solid", "path", "held"),
    ],
)
def test_what_the_model_reads_must_be_given(make_case, model, part, key):
    values = json.loads(make_case(model=model).canonical())
    del values[part][key]
    with pytest.raises(Refusal, match=rf"{part}\.{key} = None is refused"):
        Case.from_dict(values)
