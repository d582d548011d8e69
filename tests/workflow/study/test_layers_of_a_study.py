"""Layers as a list: what they are as a braid, which cases they share, and what is refused."""

import math

import pytest

from geometry.muscle import Braid, LayeredBraid
from workflow.plan.plan import plan
from workflow.study.errors import StudyError
from workflow.study.study import load

LAYERS = """[{kind: embedded, depth: 0.3, sense: clockwise, lead: 144, threads: 60},
      {kind: embedded, depth: 0.9, sense: counter-clockwise, lead: 144, threads: 60}]"""
STUDY = """\
materials:
  nbr: {c10: 0.345083, c01: 0.083805}
muscles:
  paper: {inner_diameter: 20, wall_thickness: 2, length: 300, material: nbr,
    layer_depths: [0.3, 0.9], threads: 60, lead: 144, thread_stiffness: 315}
  one: {inner_diameter: 20, wall_thickness: 2, length: 300, material: nbr, thread_stiffness: 315,
    layers: LAYERS}
scenes:
  curves: {path: isobaric, muscles: [one], pressure: 0.3, contraction: [0, 0.1], models: [MODEL]}
"""
SLEEVE = "[{kind: sleeve, gap: 1, threads: 60, angle: 25}]"


@pytest.fixture
def planned(tmp_path):
    def made(layers=LAYERS, *, model="cylinder", **changed):
        text = STUDY.replace("LAYERS", layers).replace("MODEL", model)
        for old, new in changed.values():
            assert old in text
            text = text.replace(old, new)
        path = tmp_path / "study.yaml"
        path.write_text(text)
        return plan(load(path))

    return made


def braid(planned, layers, **changed):
    return planned(layers, **changed).study.muscles["one"].muscle.braid


def test_two_alike_are_the_muscle_of_the_paper(planned):
    made = planned()
    one, paper = (made.study.muscles[name] for name in ("one", "paper"))
    assert isinstance(one.muscle.braid, Braid)
    assert one.muscle == paper.muscle
    assert one.thread == paper.thread
    both = planned(muscles=("muscles: [one]", "muscles: [one, paper]"))
    assert len(both.cases) == 1


def test_sleeve_of_both_families(planned):
    found = braid(planned, SLEEVE)
    assert math.degrees(found.angle) == pytest.approx(25)
    assert found == LayeredBraid(
        kinds=("sleeve",),
        layer_diameters=(26.0,),
        leads=found.leads,
        threads=(60,),
        senses=(0,),
        stiffness_shares=(1.0,),
    )


def test_sleeve_of_another_length(planned):
    """MUSCLES: R_f 6.35, 30 degrees, 220 mm drawn to 200: 38.06648 degrees at 7.830508 mm."""
    text = "[{kind: sleeve, free_radius: 6.35, free_length: 220, threads: 30, angle: 30}]"
    size = "inner_diameter: {}, wall_thickness: {}, length: {}, material: nbr, thread_stiffness"
    small = size.format(20, 2, 300), size.format(9.5, 1.6, 200)
    found = braid(planned, text, size=small)
    assert found.layer_diameters[0] / 2 == pytest.approx(7.830508, abs=1e-6)
    assert math.degrees(found.angle) == pytest.approx(38.06648, abs=1e-5)


def test_stiffness_of_modulus_and_diameter(planned):
    text = (
        "[{kind: embedded, depth: 1, sense: both, threads: 30, angle: 25, thread_modulus: 2100, "
        "thread_diameter: 0.4}, {kind: sleeve, threads: 60, angle: 25}]"
    )
    made = planned(text).study.muscles["one"]
    area = math.pi * 0.4**2 / 4
    assert made.thread.stiffness == 315
    assert made.muscle.braid.stiffness_shares == pytest.approx((2100 * area / 315, 1))


def test_a_base_gives_what_its_layers_do_not_say(planned):
    """And other layers replace those of the base, or its depths."""
    both = "muscles: [one]", "muscles: [one, two, three]"
    more = (
        "scenes:",
        "  two: {base: paper, layers: [{kind: sleeve}]}\n"
        "  three: {base: one, layer_depths: [0.3, 0.9], threads: 60, lead: 144}\nscenes:",
    )
    made = planned(SLEEVE, both=both, more=more).study.muscles
    assert made["two"].muscle.braid.threads == (60,)
    assert made["two"].muscle.braid.leads == (144,)
    assert made["three"].muscle == made["paper"].muscle


def test_collar_of_a_sleeve(planned):
    """Wider than the tube it is of the muscle; as wide it is what there is without."""
    for text, crimps in (("crimp_radius: 12.5", (12.5,)), ("crimp_radius: 12", ()), ("", ())):
        made = planned(SLEEVE.replace("gap: 1", f"gap: 1, {text}".rstrip(", "))).study.muscles
        assert made["one"].muscle.braid.crimp_radii == crimps


EMBEDDED = "{kind: embedded, depth: 0.3, sense: clockwise, lead: 144, threads: 60}"
REFUSED = [
    # (layers, key named, what is said)
    ("[]", "layers", "allowed: at least 1 item"),
    ("[{depth: 1}]", "layers.0.kind", "must be given"),
    ("[{kind: woven}]", "layers.0.kind", "embedded, sleeve"),
    ("[{kind: sleeve, depth: 1}]", "layers.0.depth", "not used by kind: sleeve"),
    ("[{kind: embedded, gap: 1}]", "layers.0.gap", "not used by kind: embedded"),
    ("[{kind: embedded, sense: both, lead: 144, threads: 6}]", "layers.0.depth", "must be given"),
    (LAYERS.replace("0.9", "2.9"), "layers.1.depth", "less than the wall thickness of 2"),
    (LAYERS.replace("counter-clockwise", "left"), "layers.1.sense", "counter-clockwise, both"),
    (LAYERS.replace("sense: clockwise, ", ""), "layers.0.sense", "clockwise, counter"),
    (LAYERS.replace("lead: 144, ", ""), "layers.0.angle", "exactly one of"),
    (LAYERS.replace("lead: 144", "lead: 144, angle: 3"), "layers.0.angle", "exactly one of"),
    (LAYERS.replace("lead: 144", "angle: 95"), "layers.0.angle", "less than 90"),
    (LAYERS.replace("lead: 144", "lead: 1e7"), "layers.0.lead", "from 0.25 to 89.75 degrees"),
    (LAYERS.replace("threads: 60", "threads: 0"), "layers.0.threads", "greater than or equal to 1"),
    (LAYERS.replace(", threads: 60", ""), "layers.0.threads", "here or for the muscle"),
    (SLEEVE.replace("gap: 1", "gap: 40"), "layers.0.gap", "from -6 to 24"),
    (SLEEVE.replace("gap: 1", "gap: 0.0005"), "", "warning"),
    (SLEEVE.replace("gap: 1", "gap: 1, free_radius: 13"), "layers.0.gap", "says the same"),
    (SLEEVE.replace("gap: 1", "free_length: 100"), "layers.0.free_length", "can be drawn to"),
    (
        SLEEVE.replace("gap: 1", "crimp_radius: 13"),
        "layers.0.crimp_radius",
        "from 12, the tube's outer radius, to ",
    ),
    (
        "[{kind: sleeve, gap: 1, crimp_radius: 12.5, lead: 150, threads: 60},"
        " {kind: sleeve, gap: 2, crimp_radius: 12.5, lead: 150, threads: 60}]",
        "layers.1.crimp_radius",
        "one sleeve of a muscle",
    ),
    (SLEEVE.replace("gap: 1", "thread_modulus: 60e3"), "layers.0.thread_diameter", "beside"),
    (
        SLEEVE.replace("gap: 1", "thread_diameter: 3"),
        "layers.0.thread_diameter",
        "at most 1.14 mm, with 60 threads",
    ),
    (SLEEVE.replace("threads: 60", "threads: 9999"), "layers.0.threads", "even at 130 GPa"),
    (SLEEVE.replace("gap: 1", "bending_stiffness: 1"), "layers.0.bending_stiffness", "no model"),
    (SLEEVE.replace("gap: 1", "slip: 0.1"), "layers.0.slip", "no model has slip of threads"),
    (SLEEVE.replace("gap: 1", "friction: 0.1"), "layers.0.friction", "no model has slip"),
    (SLEEVE.replace("gap: 1", "colour: red"), "layers.0.colour", "allowed: kind, depth"),
]


@pytest.mark.parametrize(("layers", "key", "said"), REFUSED)
def test_refused(planned, layers, key, said):
    if said == "warning":
        (warning,) = planned(layers).study.warnings
        assert "layers.0.gap = 0.0005 is unusual" in warning
        assert "0.5 mm" in warning
        return
    with pytest.raises(StudyError) as caught:
        planned(layers)
    text = str(caught.value)
    assert f": muscles.one.{key}" in text
    assert said in text
    assert "study.yaml:7" in text or "study.yaml:8" in text


ANGLES = LAYERS.replace("depth: 0.9, sense: counter-clockwise, lead: 144",
                        "depth: 0.9, sense: counter-clockwise, angle: 40")  # fmt: skip
NUMBERS = LAYERS.replace("lead: 144, threads: 60}]", "lead: 144, threads: 30}]")


@pytest.mark.parametrize("model", ["membrane", "solid", "cell", "geometric"])
@pytest.mark.parametrize("layers", [ANGLES, NUMBERS, f"[{EMBEDDED}]"])
def test_what_twists_is_for_the_cylinder_alone(planned, layers, model):
    assert len(planned(layers).cases) == 1
    with pytest.raises(StudyError) as caught:
        planned(layers, model=model)
    assert "allowed: cylinder" in str(caught.value)
    assert (
        model == "cell" or "one braid angle" in str(caught.value) or "twists" in str(caught.value)
    )


def test_cell_keeps_one_lead(planned):
    with pytest.raises(StudyError, match="two embedded layers have one lead"):
        planned(SLEEVE, model="cell")


def test_a_sleeve_does_not_push(planned):
    variant = ("scenes:", "variants: {stiff: {effects: {threads: two_way}}}\nscenes:")
    named = ("models:", "variants: [stiff], models:")
    with pytest.raises(StudyError, match="a sleeve lies on the wall"):
        planned(SLEEVE, variant=variant, named=named)


@pytest.mark.parametrize("layers", [SLEEVE, ANGLES, f"[{EMBEDDED}]"])
def test_the_planner_takes_a_model_that_has_the_braid(planned, layers):
    unnamed = ", models: [cylinder]", ""
    (place,) = planned(layers, unnamed=unnamed).scenes["curves"]
    assert place.model == ("cylinder" if layers != SLEEVE else place.model)
    assert place.model != "cell"


def test_a_wide_gap_wants_the_solid(planned):
    unnamed = ", models: [cylinder]", ""
    wide = SLEEVE.replace("gap: 1", "gap: 3")
    (place,) = planned(wide, unnamed=unnamed).scenes["curves"]
    assert place.model == "solid"


def test_a_fit_wants_one_stiffness(planned):
    """A calibrated muscle is its base with another EA, which a layer with its own does not take."""
    fit = "scenes:", "calibration: {f: {muscle: one, reference: martens2017}}\nscenes:"
    assert planned(SLEEVE, fit=fit).study.calibration
    inner = "{kind: embedded, depth: 1, sense: both, angle: 25, threads: 60, thread_stiffness: 9}"
    own = f"[{inner}, {SLEEVE[1:]}"
    with pytest.raises(StudyError, match="given once, for the muscle"):
        planned(own, fit=fit)
