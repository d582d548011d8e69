"""The scorecard as pages show it: numbers with units and errors; on a figure's page its claims."""

from typing import Any

import pandas as pd

NAME = "claims"  # of the page that has them all


def for_readers(rows: pd.DataFrame, page: str) -> pd.DataFrame | None:
    """The scorecard; on the page of a figure its own claims, if there are any."""
    chosen = rows if page == NAME else rows[rows["figure"] == page]
    if chosen.empty and page != NAME:
        return None
    return pd.DataFrame(
        {
            "claim": f"{row['id']}: {row['claim']}",
            "figure": _text(row["figure"]),
            "paper": _with_unit(str(row["paper"]), row["unit"]),
            "ours": ours(row),
            "EA 50 to 650 N": _range(row["lowest_by_EA"], row["highest_by_EA"]),
            "verdict": row["verdict"],
            "why": row["why"],
        }
        for row in chosen.to_dict("records")
    )


def ours(row: dict[Any, Any]) -> str:
    """Our number with what it may be off by discretisation."""
    if pd.isna(row["ours"]):
        return ""
    text = f"{row['ours']:.3g}"
    if row["discretisation"] > 0.001 * abs(row["ours"]):
        text += f" ± {row['discretisation']:.1g}"
    return _with_unit(text, row["unit"])


def _with_unit(text: str, unit: str) -> str:
    return f"{text} {unit}" if text.lstrip("-")[:1].isdigit() and unit != "1" else text


def _range(low: float, high: float) -> str:
    return "" if pd.isna(low) or low == high else f"{low:.3g} to {high:.3g}"


def _text(value: object) -> str:
    return "" if isinstance(value, float) and pd.isna(value) else str(value)
