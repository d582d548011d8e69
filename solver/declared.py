"""What an HDF5 file says it holds, before it is read: a few bytes can declare terabytes."""

from collections.abc import Iterable
from typing import Any

import numpy as np


class Declared:
    """Counts what is to be read of an open file, which is no more than the file has bytes.

    Everything must be plain: no links to elsewhere, no chunks, no compression, no storage outside
    the file.
    """

    def __init__(self, file: Any, size: int) -> None:
        self.file, self.left = file, size

    def attributes(self, names: Iterable[str]) -> None:
        """Raise ValueError, or KeyError, unless these attributes of the file are single values."""
        for name in names:
            if self.file.attrs.get_id(name).shape != ():
                raise ValueError(f"the attribute {name} is no single value")

    def child(self, group: Any, name: str) -> Any:
        """What a group holds by a name; raises ValueError if that is somewhere else."""
        import h5py

        if not isinstance(group.get(name, getlink=True), h5py.HardLink):
            raise ValueError(f"{name} is not in this file")
        return group[name]

    def dataset(self, group: Any, name: str, kind: str, shape: tuple[int | None, ...]) -> Any:
        """A dataset of a kind (``f`` or ``S``) and a shape, None for any length; or ValueError."""
        data = self.child(group, name)
        if len(data.shape) != len(shape) or any(
            allowed not in (None, length) for allowed, length in zip(shape, data.shape, strict=True)
        ):
            raise ValueError(f"{name} has the shape {data.shape}, not {shape}")
        if data.dtype.kind != kind or (kind == "f" and data.dtype != np.float64):
            raise ValueError(f"{name} holds {data.dtype}")
        stored = data.id.get_create_plist()
        if data.chunks or stored.get_nfilters() or data.external or data.is_virtual:
            raise ValueError(f"{name} is not stored plainly")
        self.left -= data.size * data.dtype.itemsize
        if self.left < 0:
            raise ValueError(f"{name} of shape {data.shape} is more than the file holds")
        return data
