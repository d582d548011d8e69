"""What an HDF5 file says it holds, before it is read: a few bytes can declare terabytes."""

import math
from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from solver.plain_hdf5 import get, type_of

DOUBLE = np.dtype(float)
PLAIN = (0, 1)  # H5D_COMPACT, H5D_CONTIGUOUS


class Declared:
    """Counts what is to be read of an open file, which is no more than the file has bytes.

    Everything must be plain: no links to elsewhere, no chunks, no compression, no storage outside
    the file.
    """

    def __init__(self, file: Any, size: int) -> None:
        self.file, self.left = file, size

    def attributes(self, names: Iterable[str]) -> None:
        """Raise ValueError, or KeyError, unless these attributes of the file are single values."""
        attributes = self.file.attrs
        for name in names:
            if attributes.get_id(name).shape != ():
                raise ValueError(f"the attribute {name} is no single value")

    def child(self, group: Any, name: str) -> Any:
        """The group that a group holds by a name; raises ValueError if that is somewhere else."""
        self._here(group, name)
        return group[name]

    def dataset(
        self, group: Any, name: str, kind: str, shape: tuple[int | None, ...]
    ) -> NDArray[Any]:
        """What a dataset of a kind (``f`` or ``S``) and a shape, None for any length, holds.

        Raises ValueError, or KeyError, if it is none.
        """
        from h5py import h5d

        self._here(group, name)
        data = h5d.open(group.id, name.encode())
        found, stored = data.shape, data.get_type()
        if len(found) != len(shape) or any(
            allowed not in (None, length) for allowed, length in zip(shape, found, strict=True)
        ):
            raise ValueError(f"{name} has the shape {found}, not {shape}")
        dtype = DOUBLE if kind == "f" and stored.equal(type_of(DOUBLE)) else stored.dtype
        if dtype.kind != kind or (kind == "f" and dtype != DOUBLE):
            raise ValueError(f"{name} holds {dtype}")
        made = data.get_create_plist()
        contiguous = made.get_layout() in PLAIN
        if not contiguous or made.get_nfilters() or made.get_external_count():
            raise ValueError(f"{name} is not stored plainly")
        self.left -= math.prod(found) * dtype.itemsize
        if self.left < 0:
            raise ValueError(f"{name} of shape {found} is more than the file holds")
        return get(data, found, dtype)

    def _here(self, group: Any, name: str) -> None:
        """Raise ValueError, or KeyError, unless what a group holds by a name is in this file."""
        from h5py import h5l

        if group.id.links.get_info(name.encode()).type != h5l.TYPE_HARD:
            raise ValueError(f"{name} is not in this file")
