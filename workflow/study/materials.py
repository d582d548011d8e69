"""The materials of a study file: of each the rubber, and what is known of it beside its law."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from geometry.refusal import Refusal
from solver.memory import Memory
from solver.rubber import LAWS
from solver.rubber.rubber_law import LEAST_KAPPA, RubberLaw
from workflow.study import in_time, units
from workflow.study.errors import AlreadyRefused, Findings
from workflow.study.installation import Installation
from workflow.study.limits import Limits
from workflow.study.schema import MaterialEntry
from workflow.study.source import Source


@dataclass(frozen=True)
class Materials:
    """Those that are sound, by name.

    Attributes
    ----------
    memories : of those that have one
    installations : with the density alone, which muscles complete; of those whose limits are sound
    """

    rubbers: dict[str, RubberLaw] = field(default_factory=dict)
    limits: dict[str, Limits] = field(default_factory=dict)
    memories: dict[str, Memory] = field(default_factory=dict)
    installations: dict[str, Installation] = field(default_factory=dict)


def read(source: Source, found: Findings, entries: Mapping[str, MaterialEntry]) -> Materials:
    """The materials of their entries; all that is wrong with them is noted."""
    made = Materials()
    for name, entry in entries.items():
        keys = ("materials", name)
        with found.gathering():
            if entry.memory is not None:
                made.memories[name] = in_time.memory(source, (*keys, "memory"), entry.memory)
        with found.gathering():
            made.rubbers[name] = _rubber(source, found, name, entry)
        with found.gathering():
            values = entry.model_dump(include={"stretch_limit", "fitted_range"})
            made.limits[name] = source.checked(keys, Limits, values)
            values = entry.model_dump(include={"density"})
            made.installations[name] = source.checked(keys, Installation, values)
    return made


def _rubber(source: Source, found: Findings, name: str, entry: MaterialEntry) -> RubberLaw:
    """The rubber of an entry; a bulk modulus that was left out is not to blame."""
    keys = ("materials", name)
    unread = {"stretch_limit", "fitted_range", "density", "law", "memory"}
    law, values = LAWS[entry.law], entry.model_dump(exclude=unread)
    refused = list(law.out_of_range(values))
    for refusal in refused:
        found.add(source.refuse((*keys, refusal.field), refusal.value, refusal.allowed))
    if refused:
        raise AlreadyRefused
    try:
        return law(**values)
    except Refusal as refusal:
        blamed, allowed = refusal.field, refusal.allowed
        names = [parameter.name for parameter in law.parameters()]
        unusual = [key for key in names if units.guess(key, values[key])]
        if blamed == "kappa" and (unusual or not source.has((*keys, "kappa"))):
            blamed = unusual[0] if unusual else _stiffest(law, values)
            kappa = values["kappa"]
            allowed = (
                f"an initial shear modulus up to {kappa / LEAST_KAPPA:g} MPa "
                f"at a kappa of {kappa:g} MPa"
            )
        raise source.refuse((*keys, blamed), values[blamed], allowed) from None


def _stiffest(law: type[RubberLaw], values: Mapping[str, Any]) -> str:
    """The parameter that has the largest stress."""
    stress = {p.name: np.max(values[p.name]) for p in law.parameters() if p.unit == "MPa"}
    return max(stress, key=stress.__getitem__)
