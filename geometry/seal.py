"""The checksum at the end of a mesh file: a mesh that was cut off or changed is no mesh.

It stands in a comment, so that FreeFEM, gmsh and meshio read the file as ever.
"""

import hashlib
from pathlib import Path

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


def _filled(comment: str, content: bytes) -> bytes:
    return comment.format(hashlib.sha256(content).hexdigest()).encode()
