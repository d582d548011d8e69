"""What smearing the threads costs: single threads in the periodic cell against smeared layers.

Four sets of cases, told apart by the tag ``set``:

correction  single threads and smeared layers of the same radial spread, NBR and silicone, three
            pressures, walls 1.5 to 3 mm, 0 to 20 % of contraction: the weight of the effect
            "discrete threads", and the answer to claim C8 (silicone's maximum at 2 mm)
mesh        the force on finer and finer meshes, for threads, smeared layers, and the wire of zero
            thickness, which has no limit
twist       held and free ends
picture     one state of both rubbers on the finest mesh, with its fields, threads and smeared
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pandas as pd

from geometry.cell import CellMesh
from geometry.muscle import Muscle
from solver.case import Case
from solver.effects import Effects, Layers, Twist
from solver.load_path import LoadPath, PathKind
from solver.numerics import Numerics
from workflow.analyses.analysis import Solved, StudyCase
from workflow.analyses.threads import local
from workflow.study.contents import Study

MUSCLES = {"NBR": "dmsp20", "silicone": "dmsp20_silicone"}  # of the study file
CONTRACTIONS = (0.0, 0.05, 0.1, 0.15, 0.2)
PRESSURES = (0.2, 0.3, 0.4)  # MPa
WALLS = (1.5, 2.0, 2.5, 3.0)  # mm
PRESSURE, WALL, CONTRACTION = 0.3, 2.0, 0.1  # where nothing else is said
THREAD_SIZES = (1.5, 1.0, 0.8, 0.65)  # of the tetrahedra at a thread, in thread radii
BODY_SIZE = 0.25  # wall thicknesses, of the meshes of the set "mesh"
COLUMNS = {  # of the record -> of the table
    "contraction": "contraction [1]",
    "force": "force [N]",
    "inner_diameter_inflated": "inner diameter [mm]",
    "bulge": "bulge [mm]",
    "twist": "twist rate [rad/mm]",
    "thread_stretch_min": "smallest thread stretch [1]",
    "thread_stretch_max": "largest thread stretch [1]",
    "min_det_f": "smallest det F [1]",
    "min_det_f_nodes": "smallest det F at corners [1]",
}
STRESS, CONCENTRATION = "largest principal stress [MPa]", "stress concentration [1]"
SAME = ["set", "rubber", "wall [mm]", "pressure [MPa]", "size", "twist", "contraction [1]"]


def cases(study: Study) -> list[StudyCase]:
    """All cases, by set."""
    return [*_correction(study), *_mesh(study), *_twist(study), *_picture(study)]


def table(solved: Sequence[Solved]) -> pd.DataFrame:
    """One row per state.

    ``change [N]`` is the force beyond that of smeared layers, where there are both, and
    ``share [1]`` the same over the largest force of the curve of smeared layers. Pictures have the
    largest stress of their rubber, and how many times that of smeared layers it is; in the set
    ``tension`` a row is a place along a thread instead.
    """
    rows = pd.concat([_rows(entry) for entry in solved], ignore_index=True)
    smeared = rows[rows["layers"] == Layers.SMEARED]
    known, known_stress = (smeared.set_index(SAME)[name] for name in ("force [N]", STRESS))
    curves = [key for key in SAME if key != "contraction [1]"]
    largest = smeared.groupby(curves)["force [N]"].agg(lambda force: force.abs().max())
    against = known.reindex(pd.MultiIndex.from_frame(rows[SAME])).to_numpy()
    scale = largest.reindex(pd.MultiIndex.from_frame(rows[curves])).to_numpy()
    rows["change [N]"] = rows["force [N]"] - against
    rows["share [1]"] = rows["change [N]"] / scale
    stress = known_stress.reindex(pd.MultiIndex.from_frame(rows[SAME])).to_numpy()
    rows[CONCENTRATION] = rows[STRESS] / stress
    along = [_tension(entry) for entry in solved if entry.solution.fields]
    return pd.concat([rows, *along], ignore_index=True)


def draw(solved: Sequence[Solved], rows: pd.DataFrame) -> dict[str, Any]:
    """The figures of the study; matplotlib is imported only for them."""
    from workflow.analyses.threads import figures

    return {
        "threads": figures.local(shown(solved), rows),
        "threads_correction": figures.correction(rows),
    }


def shown(solved: Sequence[Solved]) -> dict[str, Solved]:
    """By rubber the case with single threads whose fields the picture shows, where it has them."""
    return {
        str(entry.asked.tags["rubber"]): entry
        for entry in solved
        if entry.asked.case.fields_at
        and entry.solution.fields
        and entry.asked.tags["layers"] == Layers.DISCRETE
    }


def of_claim(study: Study) -> list[StudyCase]:
    """Claim C8: silicone at the claim's pressure, by wall, with single threads and smeared."""
    return [
        entry
        for entry in _correction(study)
        if entry.tags["rubber"] == "silicone" and entry.tags["pressure [MPa]"] == PRESSURE
    ]


def change_by_wall(solved: Sequence[Solved], contraction: float = CONTRACTION) -> pd.Series:
    """What single threads change of the force [N], by wall thickness [mm]; of ``of_claim``."""
    rows = table(solved)
    chosen = (rows["layers"] == Layers.DISCRETE) & np.isclose(rows["contraction [1]"], contraction)
    return rows[chosen].set_index("wall [mm]")["change [N]"].sort_index()


def _rows(entry: Solved) -> pd.DataFrame:
    states, case = entry.solution.states, entry.asked.case
    rows = pd.DataFrame({name: states[key] for key, name in COLUMNS.items()})
    rows["contraction [1]"] = case.path.stops  # exact, and also where nothing was reached
    rows["status"] = [status.value for status in entry.solution.state_status]
    rows["unknowns [1]"] = entry.solution.unknowns
    rows[STRESS] = np.nan
    for state, fields in entry.solution.fields.items():
        rows.loc[state, STRESS] = local.largest_stress(fields)
    return _tagged(rows, entry)


def _tension(entry: Solved) -> pd.DataFrame:
    return _tagged(local.tension(entry), entry).assign(set="tension")


def _tagged(rows: pd.DataFrame, entry: Solved) -> pd.DataFrame:
    for tag, value in reversed(entry.asked.tags.items()):
        rows.insert(0, tag, value)
    return rows


def _case(
    study: Study,
    name: str,
    rubber: str,
    *,
    wall: float = WALL,
    pressure: float = PRESSURE,
    size: float | None = None,
    stops: tuple[float, ...] = CONTRACTIONS,
    fields_at: tuple[float, ...] = (),
    layers: Layers = Layers.DISCRETE,
    twist: Twist = Twist.HELD,
) -> StudyCase:
    ours = study.muscles[MUSCLES[rubber]]
    muscle: Muscle = replace(ours.muscle, wall_thickness=wall)
    mesh = CellMesh() if size is None else CellMesh(thread_size=size, body_size=BODY_SIZE)
    case = Case(
        muscle=muscle,
        rubber=ours.rubber,
        thread=ours.thread,
        path=LoadPath(kind=PathKind.ISOBARIC, held=pressure, stops=stops),
        model="cell",
        effects=Effects(layers=layers, twist=twist),
        numerics=Numerics(cell=mesh),
        fields_at=fields_at,
    )
    tags: dict[str, str | float] = {
        "set": name,
        "rubber": rubber,
        "layers": layers.value,
        "twist": twist.value,
        "wall [mm]": wall,
        "pressure [MPa]": pressure,
        "size": CellMesh().thread_size if size is None else size,
    }
    return StudyCase(case, " ".join(map(str, tags.values())), tags)


def _correction(study: Study) -> Iterator[StudyCase]:
    for rubber in MUSCLES:
        for pressure in PRESSURES:
            for wall in WALLS:
                for layers in (Layers.DISCRETE, Layers.SMEARED):
                    yield _case(
                        study, "correction", rubber, wall=wall, pressure=pressure, layers=layers
                    )


def _mesh(study: Study) -> Iterator[StudyCase]:
    for layers in (Layers.DISCRETE, Layers.SMEARED, Layers.WIRE):
        for size in THREAD_SIZES:
            yield _case(study, "mesh", "NBR", size=size, layers=layers, stops=(0.0, 0.1, 0.2))


def _twist(study: Study) -> Iterator[StudyCase]:
    for twist in Twist:
        for layers in (Layers.DISCRETE, Layers.SMEARED):
            yield _case(study, "twist", "NBR", twist=twist, layers=layers)


def _picture(study: Study) -> Iterator[StudyCase]:
    at = (CONTRACTION,)
    for rubber in MUSCLES:
        for layers in (Layers.DISCRETE, Layers.SMEARED):
            yield _case(
                study,
                "picture",
                rubber,
                size=min(THREAD_SIZES),
                stops=at,
                fields_at=at,
                layers=layers,
            )
