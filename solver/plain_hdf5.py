"""Datasets of an HDF5 file written and read by h5py's low-level calls.

A record has sixty with a hundred attributes, all of a few types. What h5py's own interface does
besides for each takes two thirds of the time, for a study of a thousand cases minutes.
"""

from collections.abc import Mapping
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray


def put(group: Any, name: str, value: Any, attributes: Mapping[str, str]) -> None:
    """Write a number, a text, a list or an array, with attributes, in the groups that it names."""
    from h5py import h5a, h5d, h5s

    texts = isinstance(value, str) or (isinstance(value, list) and isinstance(value[0], str))
    array = np.asarray(value, dtype=_text() if texts else None, order="C")
    plain, inside = _properties()
    data = h5d.create(
        group.id, name.encode(), type_of(array.dtype), _space(array.shape), plain, inside
    )
    data.write(h5s.ALL, h5s.ALL, array)
    for key, said in attributes.items():
        attribute = h5a.create(data, key.encode(), type_of(_text()), _space(()))
        attribute.write(np.array(said, dtype=_text()))


def get(data: Any, shape: tuple[int, ...], dtype: np.dtype[Any]) -> NDArray[Any]:
    """All that a low-level dataset of doubles or bytes holds, whose shape and type are these.

    To ask the dataset for them again, or HDF5 for the type of each array, is a third of reading it.
    """
    from h5py import h5s

    found = np.empty(shape, dtype)
    data.read(h5s.ALL, h5s.ALL, found, type_of(dtype) if dtype.kind == "f" else None)
    return found


@cache
def _text() -> Any:
    import h5py

    return h5py.string_dtype()


@cache
def type_of(dtype: Any) -> Any:
    """HDF5's type for one of numpy."""
    from h5py import h5t

    return h5t.py_create(dtype, logical=True)


@cache
def _space(shape: tuple[int, ...]) -> Any:
    from h5py import h5s

    return h5s.create_simple(shape) if shape else h5s.create(h5s.SCALAR)


@cache
def _properties() -> tuple[Any, Any]:
    """How datasets are made, without their times; and that groups in their names are made too."""
    from h5py import h5p, h5t

    plain, inside = h5p.create(h5p.DATASET_CREATE), h5p.create(h5p.LINK_CREATE)
    plain.set_obj_track_times(False)
    inside.set_create_intermediate_group(True)
    inside.set_char_encoding(h5t.CSET_UTF8)
    return plain, inside
