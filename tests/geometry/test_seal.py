"""A mesh file carries its checksum, and those who read meshes do not mind."""

import gmsh
import meshio
import pytest

from geometry import meridian, section
from geometry.mesh_settings import MeridianMesh, SectionMesh
from geometry.seal import is_sealed, seal


@pytest.fixture(params=["mesh", "msh"])
def mesh(request, muscle, tmp_path):
    path = tmp_path / f"a.{request.param}"
    if request.param == "mesh":
        meridian.write(muscle, MeridianMesh(), path)
    else:
        section.write(muscle, SectionMesh(), "butt", path)
    return path


def test_a_written_mesh_is_sealed(mesh):
    assert is_sealed(mesh)


@pytest.mark.parametrize("place", range(0, 1000, 83))
def test_a_flipped_bit_anywhere(mesh, place):
    content = bytearray(mesh.read_bytes())
    content[place * len(content) // 1000] ^= 1 << place % 8
    mesh.write_bytes(content)
    assert not is_sealed(mesh)


@pytest.mark.parametrize("share", [0, 0.001, 0.5, 0.9, 0.999])
def test_truncated(mesh, share):
    content = mesh.read_bytes()
    mesh.write_bytes(content[: int(share * len(content))])
    assert not is_sealed(mesh)


def test_a_changed_number(mesh):
    mesh.write_text(mesh.read_text().replace("10", "11", 1))
    assert not is_sealed(mesh)


def test_others_read_it(mesh):
    assert len(meshio.read(mesh).points) > 10
    gmsh.initialize()
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.open(str(mesh))
        assert len(gmsh.model.mesh.getNodes()[0]) > 10
    finally:
        gmsh.finalize()


def test_a_mesh_that_was_cut_off_is_not_sealed(mesh):
    """Because of a full disk, of which gmsh says nothing."""
    mesh.write_bytes(mesh.read_bytes()[:200])
    with pytest.raises(OSError, match="disk full"):
        seal(mesh)
