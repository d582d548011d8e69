"""What of a table has no place in its figure, in words: nothing vanishes without any."""

from collections.abc import Iterable

import pandas as pd


def sentence(names: Iterable[str], what: str = "Not drawn") -> str:
    """``Not drawn: a, b.``; empty where all is drawn."""
    found = list(dict.fromkeys(names))
    return f"{what}: {', '.join(found)}." if found else ""


def without_value(table: pd.DataFrame, column: str, by: list[str], rows_are: str = "") -> list[str]:
    """What lacks a value, or some of them, by some columns that name it; what is counted."""
    unit = f" {rows_are}" if rows_are else ""
    found = []
    for names, rows in table.groupby(by, sort=False, dropna=False):
        missing = int(rows[column].isna().sum())
        if missing:
            share = "" if missing == len(rows) else f" ({missing} of {len(rows)}{unit})"
            found.append(" ".join(str(name) for name in names if str(name)) + share)
    return found
