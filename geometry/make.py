"""Files of a muscle by their specification.

Each kind is a module of this package with ``KEYS``, those of its specification beside kind and
muscle, if need be ``OPTIONAL`` ones, and ``from_spec``. It is found by its name, and the others are
not imported.
"""

from collections.abc import Mapping
from importlib import import_module
from pathlib import Path
from typing import Any

from geometry.grading import UnbuildableMesh
from geometry.muscle import Muscle

FOLDER = Path(__file__).parent


def kinds() -> list[str]:
    """Kinds of files: modules of this package that make one of a specification."""
    return [path.stem for path in sorted(FOLDER.glob("*.py")) if load(path.stem)]


def load(kind: object) -> Any:
    """The module of a kind; None if there is none."""
    known = isinstance(kind, str) and kind.isidentifier() and (FOLDER / f"{kind}.py").is_file()
    if not known or kind == "__main__":
        return None
    module = import_module(f"geometry.{kind}")
    return module if hasattr(module, "from_spec") else None


def make(spec: Mapping[str, Any], output: Path) -> None:
    """Write what a specification describes.

    Raises
    ------
    Refusal
        Naming the field, its value and what is allowed.
    """
    kind = spec.get("kind") if isinstance(spec, Mapping) else None
    module = load(kind)
    if module is None:
        raise UnbuildableMesh("kind", kind, ", ".join(kinds()))
    keys = {"kind", "muscle", *module.KEYS}
    optional: set[str] = getattr(module, "OPTIONAL", set())
    if not keys <= spec.keys() <= keys | optional:
        also = f", and {sorted(optional)} or none of them" if optional else ""
        raise UnbuildableMesh("keys", sorted(spec), f"exactly {sorted(keys)}{also}")
    module.from_spec(Muscle.from_dict(spec["muscle"]), spec, output)
