"""The checksum at the end of a mesh file: a mesh that was cut off or changed is no mesh.

It stands in a comment, so that FreeFEM, gmsh and meshio read the file as ever. Where there can be
no mesh, its file says why instead.
"""

import hashlib
from pathlib import Path

from geometry.files import atomic_write

NO_MESH = b"no mesh: "
COMMENTS = {  # by the last word of the mesh itself
    b"End": "# sha256 {}\n",  # Medit
    b"$EndElements": "$Comments\nsha256 {}\n$EndComments\n",  # MSH 2.2
}


def seal(path: Path) -> None:
    """Add the checksum to a mesh that was just written.

    Raises
    ------
    OSError
        If the mesh does not end as it should: gmsh does not say when the disk is full.
    """
    content = path.read_bytes()
    for last, comment in COMMENTS.items():
        if content.endswith(last + b"\n"):
            with path.open("ab") as file:
                file.write(_filled(comment, content))
            return
    raise OSError(f"{path}: the mesh could not be written to its end; is the disk full?")


def is_sealed(path: Path) -> bool:
    """Whether a file is a mesh as it was written, to the last bit."""
    content = path.read_bytes()
    for comment in COMMENTS.values():
        size = len(_filled(comment, b""))
        if content[-size:] == _filled(comment, content[:-size]):
            return True
    return False


def write_why_none(path: Path, reason: str) -> None:
    """Write why there is no mesh, whole or not at all."""
    with atomic_write(path) as beside:
        beside.write_bytes(NO_MESH + " ".join(reason.split()).encode()[:4000] + b"\n")


def why_none(path: Path) -> str:
    """Why there is no mesh in a file; empty if there is one."""
    with path.open("rb") as file:
        first = file.read(4096)
    if not (first.startswith(NO_MESH) and first.endswith(b"\n")):
        return ""
    return first.removeprefix(NO_MESH).decode(errors="replace").strip()


def _filled(comment: str, content: bytes) -> bytes:
    return comment.format(hashlib.sha256(content).hexdigest()).encode()
