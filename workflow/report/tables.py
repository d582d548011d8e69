"""Tables of results, as pages read them."""

from pathlib import Path

import pandas as pd


def read(path: Path, comment: str | None = None) -> pd.DataFrame:
    """A table; an empty cell has no value, and a text such as ``NA`` or ``none`` is a text.

    ``comment`` is what lines begin with that are no rows.
    """
    return pd.read_csv(path, comment=comment, keep_default_na=False, na_values=[""])
