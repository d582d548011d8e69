"""The table of states as Parquet: ``results/states.parquet``, one row per state.

Columns are those of its curve, of its muscle and of the state itself (workflow/data/states.py),
with units and long names as metadata of the fields. The same records give the same bytes.
"""

import io
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq

from geometry.files import atomic_write
from workflow.data.states import OF_CURVE, OF_MUSCLE, OF_STATE, Table, attributes

FILE = "states.parquet"  # in the folder of a study
COLUMNS = OF_CURVE | OF_MUSCLE | OF_STATE
COUNTS = ("state",)  # whole numbers that are there in every row


def write(table: Table, path: Path) -> None:
    """Write the table, whole or not at all."""
    rows = table.joined()
    fields = [
        pa.field(name, _kind(name), metadata=attributes(column))
        for name, column in COLUMNS.items()
        if name in rows
    ]
    arrays = [pa.array(rows[field.name], field.type, from_pandas=True) for field in fields]
    content = io.BytesIO()
    pq.write_table(pa.Table.from_arrays(arrays, schema=pa.schema(fields)), content)
    with atomic_write(path) as beside:
        beside.write_bytes(content.getvalue())


def _kind(name: str) -> pa.DataType:
    if name in COUNTS:
        return pa.int64()
    return pa.float64() if COLUMNS[name][0] or name == "held" else pa.string()
