"""The FreeFEM program of a case, and what it is given: includes, waypoints and flags."""

import math
from dataclasses import replace
from pathlib import Path

from geometry.braid import Kind, Layer, LayeredBraid
from geometry.labels import Boundary
from geometry.muscle import Muscle
from solver import continuity
from solver.case import Case
from solver.load_path import Waypoint
from solver.material import Thread
from solver.models import MODELS
from solver.zero_force import Search


def includes(case: Case) -> list[Path]:
    """Folders in which the program of a case finds its includes."""
    return [*MODELS[case.model].includes, *case.rubber.includes()]


def file(case: Case) -> Path:
    """The FreeFEM program of a case."""
    own = MODELS[case.model].program
    return own if case.path.history is None else own.with_name(f"{own.stem}_in_time.edp")


def composition(case: Case) -> str:
    """The includes of a program: one per active effect."""
    threads = case.effects.threads if case.muscle.braid else "none"
    files = [f"threads_{threads}.idp", *MODELS[case.model].composition(case)]
    macros = {"remembers": case.remembers or case.vibrates, "vibrates": case.vibrates}
    macros["rubs"] = case.rubs
    macros["hangs"] = case.hangs
    said = "".join(f"macro {name}() // EOM\n" for name, is_so in macros.items() if is_so)
    return said + "".join(f'include "{name}"\n' for name in files)


def waypoint_text(case: Case, way: list[Waypoint], *, started: bool = False) -> str:
    """The file that solver/path/output.idp reads; ``started`` where the way begins at a state."""
    wanted_fields = {k for k, stop in enumerate(case.path.stops) if stop in case.fields_at}
    lines = [f"{len(way)} {started:d} {continuity.SHARE!r}", "0 0 0 0 0 0 0"]
    if case.path.zero_force:
        search = Search.of(case)
        lines[1] = (
            f"1 {search.held:d} {float(search.still)!r} {search.swept:d} "
            f"{search.low!r} {float(search.high)!r} {search.step!r}"
        )
    for point in way:
        wanted = 0 if point.stop is None else 2 if point.stop in wanted_fields else 1
        lines.append(
            f"{point.first:d} {float(point.first_target)!r} "
            f"{point.second:d} {float(point.second_target)!r} {wanted}"
        )
    return "\n".join(lines) + "\n"


def flags(case: Case, mesh: Path) -> dict[str, str | float]:
    """Flags of solver/path/parameters.idp and of the includes that are composed in."""
    muscle, newton = case.muscle, case.numerics.newton
    values: dict[str, str | float] = {
        "mesh": str(mesh),
        "waypoints": "waypoints.txt",
        "inner_radius": muscle.inner_radius,
        "outer_radius": muscle.outer_radius,
        "half_length": muscle.length / 2,
        **case.rubber.flags(),
        "newton_tolerance": newton.tolerance,
        "newton_limit": newton.iterations,
        "smallest_step": newton.smallest_step,
        "thread_layers": 0,
        "layers": "none",
        "slack_width": 1.0,  # read by no bare tube
    }
    if case.thread is not None:
        layers = _layers(muscle, case.thread)
        values |= {
            "thread_layers": len(layers),
            "layers": ",".join(repr(float(number)) for layer in layers for number in layer),
            "slack_width": case.numerics.slack.width_of(case.thread),
        }
    values |= MODELS[case.model].flags(case)
    return {k: v if isinstance(v, str | int) else float(v) for k, v in values.items()}


def _layers(muscle: Muscle, thread: Thread) -> list[tuple[float, ...]]:
    """Of every layer what solver/path/parameters.idp reads; families of one shape are one layer."""
    found: dict[Layer, int] = {}
    for layer in muscle.layers:
        alike = layer
        if isinstance(muscle.braid, LayeredBraid):
            alike = replace(layer, threads=1, sense=1)
        found[alike] = found.get(alike, 0) + layer.threads
    return [
        (
            layer.radius,
            layer.carrier,
            math.tan(math.atan(layer.tangent)),
            count * thread.stiffness * layer.share,
            float(layer.kind is Kind.EMBEDDED),
            Boundary.OUTER.value
            if layer.kind is Kind.SLEEVE
            else Boundary.LAYER_1.value + muscle.layer_radii.index(layer.radius),
            layer.crimp,
        )
        for layer, count in found.items()
    ]
