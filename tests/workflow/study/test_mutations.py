"""Small mistakes in a valid study, made by machine: each is refused by the name of its key."""

import copy
import math

import pytest
from ruamel.yaml import YAML

from workflow.plan.plan import plan
from workflow.study.errors import StudyError
from workflow.study.study import load

from .test_study import STUDY, study_file

NAMES = [
    "a b",
    "a'b",
    'a"b',
    "$(touch x)",
    "`x`",
    "../x",
    "/x",
    "a\nb",
    "a;b",
    "",
    "é",
    "-x",
    "x" * 65,
]
WRONG = {
    # kind of the value that stands in the study: what it must not be
    "number": [
        "1 mm",
        "'7'",
        True,
        None,
        math.nan,
        math.inf,
        -math.inf,
        [1],
        {"a": 1},
        -1,
        "1e400",
    ],
    "count": [0, -1, 1.5, "many", True, math.nan, [1], 10**400],
    "name": [*NAMES, "noone", 1, None, ["one"], True],
    "names": [[], [1], "noone", {}, None, ["noone"], ["$(x)"], ["one", "one"], [["one"]]],
    "values": [
        [],
        ["a"],
        [math.nan],
        [-1e9],
        [True],
        True,
        "0.1",
        {},
        {"from": 0},
        [0.1, 0.1],
        [[1]],
    ],
    "mapping": [1, "text", [], [1], True, None],
}
KINDS = {
    # keys of the study: kind
    ("materials", "nbr", "c10"): "number",
    ("materials", "nbr", "c01"): "number",
    ("materials", "nbr", "kappa"): "number",
    ("muscles", "one", "inner_diameter"): "number",
    ("muscles", "one", "wall_thickness"): "number",
    ("muscles", "one", "length"): "number",
    ("muscles", "one", "lead"): "number",
    ("muscles", "one", "thread_stiffness"): "number",
    ("muscles", "one", "threads"): "count",
    ("muscles", "one", "material"): "name",
    ("muscles", "wide", "base"): "name",
    ("muscles", "wide", "angle_of"): "name",
    ("limits", "wall_time"): "count",
    ("limits", "memory"): "count",
    ("numerics", "newton", "tolerance"): "number",
    ("scenes", "fig04", "muscles"): "names",
    ("scenes", "fig04", "models"): "names",
    ("scenes", "fig04", "variants"): "names",
    ("scenes", "fig04", "path"): "name",
    ("scenes", "fig04", "pressure"): "values",
    ("scenes", "fig04", "contraction"): "values",
    ("variants", "paper", "effects", "end"): "name",
    ("materials",): "mapping",
    ("muscles",): "mapping",
    ("muscles", "one"): "mapping",
    ("variants", "paper"): "mapping",
    ("variants", "paper", "effects"): "mapping",
    ("numerics",): "mapping",
    ("limits",): "mapping",
    ("scenes",): "mapping",
    ("scenes", "fig04"): "mapping",
}
MAY_BE_LEFT_OUT = {("muscles", "wide"), *(("scenes", "fig04", k) for k in ("variants", "models"))}
SECTIONS = [(), *[keys for keys, kind in KINDS.items() if kind == "mapping"]]


def mutations():
    """Keys that are to be named, and the study with one mistake."""
    plain = YAML(typ="safe").load(STUDY)

    def changed(keys, change):
        study = copy.deepcopy(plain)
        place = study
        for key in keys:
            place = place[key]
        change(place)
        return study

    for keys, kind in KINDS.items():
        for wrong in WRONG[kind]:
            yield keys, changed(keys[:-1], lambda p, k=keys, w=wrong: p.update({k[-1]: w}))
        required = keys[0] in ("muscles", "scenes") and (kind != "mapping" or len(keys) == 1)
        if required and not {keys, keys[:2]} & MAY_BE_LEFT_OUT:
            yield keys, changed(keys[:-1], lambda p, k=keys: p.pop(k[-1]))
    for keys in SECTIONS:
        for unknown in ("colour", "$(touch x)", "a\nb"):
            yield (*keys, unknown), changed(keys, lambda p, u=unknown: p.update({u: 1}))
    for section in ("materials", "muscles", "variants", "scenes"):
        inner = {"materials": "nbr", "muscles": "one", "variants": "paper", "scenes": "fig04"}[
            section
        ]
        for name in NAMES:
            yield (
                (section, name),
                changed((section,), lambda p, n=name, i=inner: p.update({n: copy.deepcopy(p[i])})),
            )
    one = ("muscles", "one")
    for depths in ([0.3], [0.9, 0.3], [0, 0.9], [0.3, 2], [-0.1, 0.9], [0.3, math.nan], "0.3", 1):
        yield (*one, "layer_depths"), changed(one, lambda p, d=depths: p.update(layer_depths=d))
    for angle in (0, 90, -24.8, math.nan, "24.8 deg"):
        yield (*one, "angle"), changed(one, lambda p, a=angle: (p.pop("lead"), p.update(angle=a)))
    for step in (0, -0.05, 0.03, 1e-12, math.nan, "x", None, True):
        yield (
            ("scenes", "fig04", "contraction"),
            changed(("scenes", "fig04", "contraction"), lambda p, s=step: p.update(step=s)),
        )


ALL = list(mutations())


def text_of(study, folder):
    path = folder / "study.yaml"
    with path.open("w") as stream:
        YAML(typ="safe").dump(study, stream)
    return path.read_text()


def test_there_are_many():
    assert len(ALL) >= 250


@pytest.mark.parametrize("number", range(0, len(ALL), 20))
def test_every_mistake_is_refused_by_name(tmp_path, number):
    accepted, unnamed = [], []
    for keys, study in ALL[number : number + 20]:
        text = text_of(study, tmp_path)
        try:
            plan(load(study_file(tmp_path, text)))
        except StudyError as error:
            said = str(error)
            lines = said.splitlines()
            name = keys[-1] if keys[-1].isprintable() else repr(keys[-1])
            named = name in said and "study.yaml" in said
            if not named or len(lines) > 7 or max(map(len, lines)) > 500:
                unnamed.append((keys, said))
        else:
            accepted.append((keys, text))
    assert accepted == []
    assert unnamed == []
