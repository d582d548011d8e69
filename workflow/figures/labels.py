"""What values are called in legends, titles and notes."""

from collections.abc import Callable, Iterable
from typing import Any

import pandas as pd

from workflow.data.scene_data import ANGLE, CONTRACTION, DIAMETER, FORCE, PRESSURE, THREADS, WALL

SERIES = "series"  # column: what the curves of a figure are told apart by
SHOWN: dict[str, Callable[[Any], str]] = {
    CONTRACTION: lambda value: f"{100 * value:g} %",
    PRESSURE: lambda value: f"{value:g} MPa",
    FORCE: lambda value: f"{value:g} N",
    ANGLE: lambda value: f"{value:.1f}°",
    DIAMETER: lambda value: f"{value:g} mm",
    WALL: lambda value: f"{value:g} mm wall",
    THREADS: lambda value: f"{value:g} threads",
    "material": lambda value: "NBR" if value == "nbr" else value,
}

NOUN = {CONTRACTION: " contraction", FORCE: " load"}  # what a value alone does not say


def shown(column: str, value: Any) -> str:
    """A value as text, with its unit."""
    return SHOWN.get(column, str)(value)


def series(table: pd.DataFrame, columns: Iterable[str], *, apart: bool = True) -> pd.Series:
    """A name for every row: its values in those of the columns that vary (or in the first).

    Variants have different names, and so have different muscles if they are to be told ``apart``.
    """
    columns = [*columns, "variant"]
    varying = [column for column in columns if table[column].nunique() > 1] or columns[:1]
    names = _joined(table, varying)
    if apart and (table.groupby(names)["muscle"].nunique() > 1).any():
        names = _joined(table, [*varying, "muscle"])
    return names


def muscles(table: pd.DataFrame) -> str:
    """Which muscles the series are, as a sentence; nothing of one alone, which is in the title."""
    found = table.dropna(subset=["muscle"]).groupby(SERIES, sort=False)["muscle"].unique()
    unsaid = [
        f"{name} is {', '.join(each)}"
        for name, each in found.items()
        if not all(muscle in str(name).split(", ") for muscle in each)
    ]
    return f"Muscles: {'; '.join(unsaid)}." if table["muscle"].nunique() > 1 and unsaid else ""


def _joined(table: pd.DataFrame, columns: list[str]) -> pd.Series:
    return table[columns].apply(lambda row: ", ".join(map(shown, columns, row)), axis=1)


def constants(table: pd.DataFrame, columns: Iterable[str]) -> str:
    """The values of those columns that do not vary, as a title."""
    constant = [column for column in columns if table[column].nunique() == 1]
    return ", ".join(
        shown(column, table[column].dropna().iloc[0]) + NOUN.get(column, "") for column in constant
    )
