"""Models of the muscle, one folder each, and what those with a mesh share.

``MODELS`` finds them by their folders. A model is imported when it is asked for by its name, and
the others are not; going through all of them imports all.
"""

from collections.abc import Iterator, Mapping
from importlib import import_module

from solver.models.model import FOLDER, Model


class _Models(Mapping[str, Model]):
    """Descriptors by name, in the order of their rank."""

    def __init__(self) -> None:
        self._known: dict[str, Model] = {}

    def __getitem__(self, name: str) -> Model:
        if name not in self._known:
            if name not in self:
                raise KeyError(name)
            found: Model = import_module(f"{__name__}.{name}.model").MODEL
            if found.name != name:
                raise ImportError(f"the model in solver/models/{name} calls itself {found.name}")
            self._known[name] = found
        return self._known[name]

    def __contains__(self, name: object) -> bool:
        if not (isinstance(name, str) and name.isidentifier()):
            return False
        return name in self._known or (FOLDER / name / "model.py").is_file()

    def __iter__(self) -> Iterator[str]:
        names = (path.parent.name for path in FOLDER.glob("*/model.py"))
        return iter(sorted(names, key=lambda name: (self[name].rank, name)))

    def __len__(self) -> int:
        return sum(1 for _ in FOLDER.glob("*/model.py"))


MODELS: Mapping[str, Model] = _Models()
