"""The closed schema of a study file: which keys there are, of which kind, and what they mean.

What a value means for the mechanics, and its range, is refused where it is used (geometry/,
solver/); here stands what a file may contain. config/README.md describes every key.
"""

import re
from collections import Counter
from collections.abc import Mapping
from dataclasses import fields
from itertools import pairwise
from pathlib import PurePath
from typing import TYPE_CHECKING, Annotated, Any, Union, get_args

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Discriminator,
    Field,
    Tag,
    WithJsonSchema,
    create_model,
)
from pydantic_core import PydanticCustomError

from geometry.braid import MOST_LAYERS, Kind
from geometry.refusal import is_count
from solver.effects import EFFECTS, Effects
from solver.history import Start, Wave
from solver.load_path import ZERO_FORCE, PathKind
from solver.models import MODELS
from solver.numerics import KINDS
from solver.record import IN_TIME as STATES_IN_TIME
from solver.record import SLEEVED, VARIABLES
from solver.rubber import LAWS, default
from solver.rubber.rubber_law import Parameter
from workflow.study.errors import choices, shown
from workflow.study.values import POSSIBLE, expand, is_possible

# All models are asked what they are.
DATA = ("solver/models/*/__init__.py", "solver/models/*/model.py")
LONGEST_NAME, LONGEST_TITLE = 64, 200
NAME = re.compile(rf"[A-Za-z0-9_][A-Za-z0-9_.-]{{0,{LONGEST_NAME - 1}}}")
NAME_RULE = (
    f"letters, digits, _ . and -, at most {LONGEST_NAME}, not beginning with . or -; letters are "
    "those from a to z and A to Z"
)
ASKED = (  # those from stress on are solved for or written only when asked for
    "force",
    "contraction",
    "inner_diameter",
    "outer_diameter",
    "thread_stretch",
    "contact_pressure",
    "volume",
    "stiffness",
    "twist",
    "stress",
    "deformed_shape",
    "dynamic_stiffness",
)
FITTED = tuple(m for m in MODELS if MODELS[m].mesh and not MODELS[m].only_for)  # not too dear
MEASURED = "measured"  # errors of meshes: by a mesh twice as fine
SHEET = "sheet"  # the quantity that asks for the data sheet of a muscle
QUANTITIES = {  # models that can give it
    **{name: tuple(m for m in MODELS if name in MODELS[m].quantities) for name in ASKED},
    **{name: tuple(MODELS) for name in ZERO_FORCE},
    SHEET: tuple(m for m in MODELS if {"volume", "stiffness"} <= set(MODELS[m].quantities)),
}
TIMED = tuple(STATES_IN_TIME)  # what only states along a path in time have
SHOWN = (*VARIABLES, *SLEEVED, *TIMED, "load")  # what a figure can show of a state
REQUIRED = (  # of a design
    "force",
    "stroke",
    "free_contraction",
    "blocked_force",
    "outer_diameter",
    "length",
    "air",
    "thread_share",
    "rubber_stretch",
    "bore_stretch",
    "thread_cover",
)
MINIMISED = ("air", "outer_diameter", "mass", "length")
MAXIMISED = ("force", "work")
FORCE_MAPS = (  # read by workflow/data/reference.py
    "festo_musclesim_dmsp40",
    "martens2017_dmsp10",
    "sarosi2012",
    "festo_musclesim",
    "martens2017",
)
MOST_THREADS = 10_000  # more is a typing error
IN_TIME = ("cycle", "transient")  # paths beside those of PathKind
OF_TIME = ("memory", "friction")  # effects of muscles that only scenes in time have
KIND_OF_HELD = {kind.held.key: kind.value for kind in PathKind}
SENSES = {"clockwise": 1, "counter-clockwise": -1, "both": 0}  # of a layer
_NO_BENDING = "nothing: no model has the bending of threads, which bend without resistance"
_NO_SLIP = (
    "nothing: no model has slip of threads; in rubber they are bonded, and a sleeve moves along "
    "with the surface on which it lies; its crossings have `friction` in time, a key of the muscle"
)
INEXPRESSIBLE = {  # keys that one might look for
    **dict.fromkeys(("bending", "bending_stiffness", "thread_bending"), _NO_BENDING),
    **dict.fromkeys(("slip", "thread_slip", "friction", "thread_friction"), _NO_SLIP),
}
HELD_KEY = {kind.value: kind.held.key for kind in PathKind}
SWEPT_KEY = {kind.value: kind.swept.key for kind in PathKind}


def refusal(allowed: str) -> PydanticCustomError:
    """An error whose message says what would have been accepted."""
    return PydanticCustomError("refused", "{allowed}", {"allowed": allowed})


def _name(value: str) -> str:
    if not NAME.fullmatch(value):
        raise refusal(NAME_RULE)
    return value


def _values(value: object) -> tuple[float, ...]:
    try:
        return expand(value)
    except ValueError as error:
        raise refusal(str(error)) from None


def _one_of(*allowed: str) -> Any:
    """One name out of ``allowed``."""

    def check(value: object) -> object:
        if value not in allowed:
            raise refusal(choices(value, allowed))
        return value

    return Annotated[str, BeforeValidator(check), WithJsonSchema({"enum": [*allowed]})]


def _some_of(*allowed: str) -> Any:
    """Names out of ``allowed``, each once; their order means nothing."""

    def check(value: object) -> tuple[str, ...]:
        names = _each_once(value)
        for name in names:
            if name not in allowed:
                raise refusal(f"{choices(name, allowed)}; not {shown(name)}")
        return tuple(name for name in allowed if name in names)

    words = {"type": "array", "items": {"enum": [*allowed]}}
    return Annotated[tuple[str, ...], BeforeValidator(check), WithJsonSchema(words)]


def _maps(value: object) -> tuple[str, ...]:
    """Names of force maps and paths of files; the order is that of FORCE_MAPS, then the given."""
    names = _each_once(value)
    for name in names:
        if name not in FORCE_MAPS and not is_path(name):
            allowed = f"{choices(name, FORCE_MAPS)} or the path of a .csv file"
            raise refusal(f"{allowed}; not {shown(name)}")
    known = [name for name in FORCE_MAPS if name in names]
    return (*known, *(name for name in names if name not in known))


def is_path(name: object) -> bool:
    """Whether what names forces is the path of a file, and no map of this project."""
    return isinstance(name, str) and bool(PurePath(name).suffix or len(PurePath(name).parts) != 1)


def _each_once(value: object) -> list[str]:
    """A list of names; one name is a list of one."""
    if isinstance(value, str):
        return [value]
    if not isinstance(value, list) or not value or not all(isinstance(v, str) for v in value):
        raise refusal("a list of at least one name")
    twice = next((v for v, count in Counter(value).items() if count > 1), None)
    if twice is not None:
        raise refusal(f"every name once; {shown(twice)} is there twice")
    return value


def _sorted_names(value: object) -> tuple[str, ...]:
    return tuple(sorted(_each_once(value)))


COUNTED = {2: "two", 3: "three"}


def _tuple_of(kind: Any) -> Any:
    """A tuple of some numbers, which a file writes as a list."""
    count = len(get_args(kind))

    def as_tuple(value: object) -> tuple[object, ...]:
        if not isinstance(value, list) or len(value) != count:
            raise refusal(f"a list of {COUNTED[count]} numbers")
        return tuple(value)

    return Annotated[kind, BeforeValidator(as_tuple)]


def _whole(value: object) -> object:
    """30.0 is 30."""
    return int(value) if isinstance(value, float) and value.is_integer() else value


def _bounded(value: object) -> object:
    """No number beyond what quantities can be; of such, products overflow."""
    if isinstance(value, int | float) and not isinstance(value, bool) and not is_possible(value):
        raise refusal(POSSIBLE)
    return value


def _threads(value: object) -> object:
    value = _whole(value)
    if value != "none" and not (is_count(value) and value <= MOST_THREADS):
        raise refusal(f"an integer >= 1, <= {MOST_THREADS} (per layer), or none for a bare tube")
    return value


Name = Annotated[str, AfterValidator(_name)]
Names = Annotated[tuple[Name, ...], BeforeValidator(_sorted_names)]
Values = Annotated[tuple[float, ...], BeforeValidator(_values)]
Number = Annotated[float, BeforeValidator(_bounded)]
Whole = Annotated[int, BeforeValidator(_whole), BeforeValidator(_bounded)]
Range = _tuple_of(tuple[Number, Number])


class Entry(BaseModel):
    """A mapping of the file: no unknown keys, no silent conversions, no NaN."""

    model_config = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False, frozen=True)


def _numbers(value: object) -> tuple[object, ...]:
    if not isinstance(value, list) or not value:
        raise refusal("a list of at least one number")
    return tuple(value)


def _rows(value: object) -> tuple[tuple[float, float], ...]:
    """Rows of a table, whose times do not fall; two of one time are a jump."""
    allowed = "a list of at least two rows [time, value], their times rising from 0 (s)"
    rows = value if isinstance(value, list) else []
    pairs = [tuple(row) for row in rows if isinstance(row, list) and len(row) == 2]
    if len(pairs) < 2 or len(pairs) != len(rows):
        raise refusal(allowed)
    if not all(is_possible(number) for row in pairs for number in row):
        raise refusal(f"{allowed}; every number {POSSIBLE}")
    falls = any(b[0] < a[0] for a, b in pairwise(pairs))
    if pairs[0][0] != 0 or pairs[-1][0] <= 0 or falls:
        raise refusal(allowed)
    return tuple((float(time), float(number)) for time, number in pairs)


List = Annotated[tuple[Number, ...], BeforeValidator(_numbers)]
Rows = Annotated[tuple[tuple[float, float], ...], BeforeValidator(_rows)]
Positive = Annotated[Number, Field(gt=0)]
Count = Annotated[Whole, Field(gt=0, le=10_000)]


class MemoryEntry(Entry):
    """What of a rubber's stress relaxes: a flat spectrum, or shares and times of branches."""

    per_decade: Number | None = None
    from_: Number | None = Field(default=None, alias="from")  # s
    to: Number | None = None  # s
    shares: List | None = None
    times: List | None = None  # s
    reference_time: Number | None = None  # s


class MaterialEntry(Entry):
    """A rubber; each law adds its parameters."""

    law: str
    kappa: Number = 1000.0
    stretch_limit: Number | None = None
    fitted_range: Range | None = None  # of stretches
    memory: MemoryEntry | None = None
    density: Number | None = None  # g/cm3


def _one_or_more(value: object) -> tuple[object, ...]:
    """A list of numbers; one number is a list of one."""
    return tuple(value) if isinstance(value, list) else (value,)


Numbers = Annotated[tuple[Number, ...], BeforeValidator(_one_or_more)]


def _kind_of(parameter: Parameter) -> Any:
    """What a parameter of a law is in a file."""
    if parameter.words:
        return _one_of(*parameter.words)
    return Numbers if parameter.most else Number


def _material(law: str) -> type[MaterialEntry]:
    own = {
        parameter.name: (
            _kind_of(parameter),
            ... if parameter.default is None else parameter.default,
        )
        for parameter in LAWS[law].parameters()
    }
    return create_model(f"Material_{law}", __base__=MaterialEntry, law=(str, law), **own)


def law_of(entry: object) -> str | None:
    """Name of the law of a material as it is written; None if that can be no name."""
    law = entry.get("law", default().law()) if isinstance(entry, Mapping) else default().law()
    return law if isinstance(law, str) else None


MATERIALS = {law: _material(law) for law in LAWS}
if TYPE_CHECKING:
    Material = MaterialEntry
else:
    _kinds = tuple(Annotated[entry, Tag(law)] for law, entry in MATERIALS.items())
    Material = Annotated[Union[_kinds], Discriminator(law_of)]  # noqa: UP007
BOUNDS = {  # what a calibration can fit, and its bounds: first of the thread, then of rubbers
    "thread_stiffness": (10.0, 10000.0),  # N
} | {
    parameter.name: parameter.bounds
    for law in LAWS.values()
    for parameter in law.parameters()
    if parameter.bounds
}
SHAPES = ("angle", "wall_thickness", "layer_radius")  # and these, within tolerances


class LayerEntry(Entry):
    """A layer of threads; of a braid's keys what it has not it takes from its muscle."""

    kind: _one_of(*Kind)
    depth: Number | None = None  # of an embedded layer
    gap: Number | None = None  # of a sleeve
    free_radius: Number | None = None
    free_length: Number | None = None
    crimp_radius: Number | None = None
    sense: _one_of(*SENSES) | None = None
    threads: Annotated[Whole, Field(ge=1, le=MOST_THREADS)] | None = None  # of a family
    lead: Number | None = None
    angle: Number | None = None
    thread_stiffness: Number | None = None
    thread_modulus: Number | None = None
    thread_diameter: Number | None = None


def _counts(value: object) -> tuple[int, ...]:
    counts = tuple(_whole(count) for count in _values(value))
    for count in counts:
        if not (is_count(count) and count <= MOST_THREADS):
            raise refusal(f"integers >= 1, <= {MOST_THREADS}; not {count:g}")
    return counts


SWEPT = {  # keys of a muscle that a sweep may have, and what stands for them in names
    "inner_diameter": "d",
    "wall_thickness": "t",
    "length": "l",
    "threads": "n",
    "lead": "lead",
    "angle": "angle",
    "thread_stiffness": "ea",
    "material": "",
}
NOT_SWEPT = {  # keys of a muscle that one might look for there
    "layers": "layers beside the sweep, for all its muscles; others in an entry of their own",
    "cap_length": "cap_length beside the sweep, for all its muscles, or in a table of muscles",
}
_OF_SWEEP = {"threads": Annotated[tuple[int, ...], BeforeValidator(_counts)], "material": Names}
SweepEntry = create_model(
    "SweepEntry",
    __base__=Entry,
    **{key: (_OF_SWEEP.get(key, Values) | None, None) for key in SWEPT},
)


class FrictionEntry(Entry):
    """Friction of the crossings of a sleeve (solver/friction.py)."""

    coefficient: Number
    contact: Number  # mm
    slip: Number = 0.005  # rad


class MuscleEntry(Entry):
    """A muscle, or what of it differs from its ``base``; or many, by a sweep or a table."""

    base: Name | None = None
    inner_diameter: Number | None = None
    wall_thickness: Number | None = None
    length: Number | None = None
    cap_length: Number | None = None
    layer_depths: Range | None = None
    threads: Annotated[Any, BeforeValidator(_threads)] = None
    lead: Number | None = None
    angle: Number | None = None
    angle_of: Name | None = None
    friction: FrictionEntry | None = None
    layers: Annotated[list[LayerEntry], Field(min_length=1, max_length=MOST_LAYERS)] | None = None
    thread_stiffness: Number | None = None
    thread_modulus: Number | None = None
    thread_diameter: Number | None = None
    thread_strength: Number | None = None
    thread_density: Number | None = None  # g/cm3
    fitting_length: Number | None = None
    fitting_mass: Number | None = None  # g
    dead_volume: Number | None = None  # mm3
    ambient_pressure: Number | None = None
    material: Name | None = None
    reference: Annotated[tuple[str, ...], BeforeValidator(_maps)] | None = None
    sweep: SweepEntry | None = None
    table: str | None = None  # path of a CSV file


EffectsEntry = create_model(
    "EffectsEntry",
    __base__=Entry,
    **{f.name: (_one_of(*f.type), f.default) for f in fields(Effects)},
)


KIND_OF = {  # of a field of a dataclass
    float: Number,
    float | None: Number,
    int: Whole,
    tuple[int, int, int]: _tuple_of(tuple[Whole, Whole, Whole]),
}


def _overrides(name: str, kind: Any) -> type[Entry]:
    """A schema with the fields of a dataclass, all of which may be left out."""
    types = {f.name: KIND_OF[f.type] for f in fields(kind)}
    return create_model(
        f"{name}_entry", __base__=Entry, **{key: (kind | None, None) for key, kind in types.items()}
    )


NumericsEntry = create_model(
    "NumericsEntry",
    __base__=Entry,
    **{name: (_overrides(name, kind) | None, None) for name, kind in KINDS.items()},
)


class VariantEntry(Entry):
    """A set of effects and numerics."""

    effects: EffectsEntry = EffectsEntry()
    numerics: NumericsEntry = NumericsEntry()


class PromiseEntry(Entry):
    """The random muscles on which promises are tried."""

    seed: Annotated[Whole, Field(ge=0, le=10**9)] = 1
    muscles: Annotated[Whole, Field(gt=0, le=10**4)] = 200


class LimitsEntry(Entry):
    """What a case may use."""

    wall_time: Annotated[Whole, Field(gt=0, le=10**7)] = 600  # s
    memory: Annotated[Whole, Field(gt=0, le=10**7)] = 2000  # MB


class ValveEntry(Entry):
    """A valve before a muscle (solver/history.py)."""

    conductance: Number  # mm3/(s MPa)
    critical_ratio: Number = 0.3
    exponent: Number = 1.0
    dead_volume: Number = 0.0  # mm3


class HistoryEntry(Entry):
    """What paths in time have in common."""

    held: str
    start: _one_of(*Start) = Start.RELAXED.value
    preload: Number = 0.0  # s


class CycleEntry(HistoryEntry):
    """A control that goes to and fro."""

    held: _one_of(*KIND_OF_HELD)
    wave: _one_of(*Wave) = Wave.TRIANGLE.value
    table: Rows | None = None  # s and the swept control, of one cycle; instead of a wave
    period: Values | None = None  # s, one curve each
    cycles: Count = 3
    samples: Count = 100  # steps of a cycle


class TransientEntry(HistoryEntry):
    """A muscle that moves a mass, or is filled through a valve."""

    held: _one_of("load", "contraction") = "load"
    supply: Rows  # s and MPa: of the valve, or without one of the muscle
    load: Rows | None = None  # s and N, where it changes
    mass: Number = 0.0  # kg
    valve: ValveEntry | None = None
    duration: Positive  # s
    step: Positive  # s


class FigureEntry(Entry):
    """How a scene is drawn; left out, what follows against what is swept."""

    x: _one_of(*SHOWN) | None = None
    y: _one_of(*SHOWN) | None = None
    by: _one_of("muscle", "held", "variant", "model") = "muscle"  # what colours tell apart
    compare: _one_of("reference", "none") = "reference"
    title: Annotated[str, Field(max_length=LONGEST_TITLE)] = ""


class Scene(Entry):
    """The cases of one figure; without a path it has none and shows the muscles themselves."""

    muscles: Names
    path: _one_of(*PathKind, *IN_TIME) | None = None
    cycle: CycleEntry | None = None
    transient: TransientEntry | None = None
    pressure: Values | None = None  # MPa
    contraction: Values | None = None  # fraction
    load: Values | None = None  # N
    models: _some_of(*MODELS) | None = None
    variants: Names = ("default",)
    effects: dict[_one_of(*EFFECTS, *OF_TIME), _one_of("on", "off")] = {}
    frequency: Values | None = None  # Hz
    tolerance: Annotated[Number, Field(gt=0, lt=1)] | None = None  # share of the largest value
    errors: _one_of(MEASURED, "estimated") = "estimated"  # of the meshes
    quantities: _some_of(*QUANTITIES) = ()
    figure: FigureEntry | None = None

    @property
    def switches(self) -> dict[str, str]:
        """Those of the effects that are switches of a model, in time or not."""
        return {name: state for name, state in self.effects.items() if name not in OF_TIME}

    @property
    def in_time(self) -> bool:
        """Whether its curves have a history."""
        return self.path in IN_TIME

    @property
    def kind(self) -> str:
        """What is held and what swept, as a PathKind; also in time."""
        entry = {"cycle": self.cycle, "transient": self.transient}.get(self.path)
        return self.path if entry is None else KIND_OF_HELD[entry.held]

    @property
    def held(self) -> tuple[float, ...]:
        """Values of the factor that is held, one curve each."""
        return getattr(self, HELD_KEY[self.kind])

    @property
    def swept(self) -> tuple[float, ...]:
        """Stops along each curve; in time those between which it goes."""
        given = getattr(self, SWEPT_KEY[self.kind])
        if given is not None or not self.in_time:
            return given
        table = self.cycle.table if self.cycle is not None else self.transient.supply
        return tuple(sorted({value for _, value in table}))


if TYPE_CHECKING:
    BoundsEntry = Entry
else:
    BoundsEntry = create_model(  # between which values a calibration may go
        "BoundsEntry",
        __base__=Entry,
        **{name: (Range, bounds) for name, bounds in BOUNDS.items()},
    )


class ToleranceEntry(Entry):
    """How well sizes are known that a calibration may fit: start plus and minus that."""

    angle: Positive | None = None  # degree
    wall_thickness: Positive | None = None  # mm
    layer_radius: Positive | None = None  # mm, of both layers together


class CalibrationEntry(Entry):
    """A fit of a muscle to measured forces."""

    muscle: Name
    reference: str | None = None  # else the first map of the muscle
    model: _one_of(*FITTED) = "membrane"
    fit: _some_of(*BOUNDS, *SHAPES) = ("thread_stiffness",)
    bounds: BoundsEntry = BoundsEntry()
    tolerance: ToleranceEntry = ToleranceEntry()
    fit_pressure: Values | None = None  # MPa; else all measured points
    report_pressure: Values | None = None  # MPa


class FreeEntry(Entry):
    """What a design may choose: numbers between two, threads among integers, names of a list."""

    inner_diameter: Range | None = None
    wall_thickness: Range | None = None
    length: Range | None = None
    angle: Range | None = None
    threads: _tuple_of(tuple[Whole, Whole]) | None = None
    material: Names | None = None
    muscle: Names | None = None  # bases


class RequirementEntry(Entry):
    """One requirement of a design."""

    quantity: _one_of(*REQUIRED)
    at_least: Number | None = None
    at_most: Number | None = None
    contraction: Number | None = None
    pressure: Number | None = None  # MPa; else that of the design
    load: Number | None = None  # N


class DesignEntry(Entry):
    """A muscle that is asked for."""

    base: Name
    pressure: Number  # MPa
    free: FreeEntry
    require: dict[Name, RequirementEntry]
    minimise: _some_of(*MINIMISED) = ()
    maximise: _some_of(*MAXIMISED) = ()
    contraction: Number | None = None  # of the objective; else the largest that is required
    reserve: Annotated[Number, Field(ge=0, le=10)] = 0.0
    seed: Whole = 1


class MapEntry(Entry):
    """A table of a muscle for controllers and simulators."""

    muscle: Name
    pressure: Values  # MPa; more are put where the force bends
    contraction: Values
    model: _one_of(*QUANTITIES[SHEET]) = "solid"
    variant: Name = "default"
    tolerance: Annotated[Number, Field(gt=0)] = 0.1  # N
    checks: Annotated[Whole, Field(ge=0, le=1000)] = 12  # states at which its error is measured
    seed: Whole = 1


def _pairs(value: object) -> tuple[tuple[object, ...], ...]:
    rows = value if isinstance(value, list) else []
    if not rows or not all(isinstance(row, list) and len(row) == 2 for row in rows):
        raise refusal("a list of pairs of pressures: [[agonist, antagonist], ...]")
    return tuple(map(tuple, rows))


class PairEntry(Entry):
    """Two muscles that pull against each other on a pulley, by their maps."""

    agonist: Name  # maps
    antagonist: Name | None = None  # else the same
    radius: Positive  # mm
    contraction: Number  # of both where the angle is 0
    angle: Values  # degree
    pressure: Annotated[tuple[tuple[Number, Number], ...], BeforeValidator(_pairs)]  # MPa


class StudyFile(Entry):
    """The whole file."""

    materials: dict[Name, Material]
    muscles: dict[Name, MuscleEntry]
    variants: dict[Name, VariantEntry] = {}
    numerics: NumericsEntry = NumericsEntry()
    limits: LimitsEntry = LimitsEntry()
    scenes: dict[Name, Scene]
    calibration: dict[Name, CalibrationEntry] = {}
    design: dict[Name, DesignEntry] = {}
    map: dict[Name, MapEntry] = {}
    pair: dict[Name, PairEntry] = {}
    promise: PromiseEntry = PromiseEntry()
