"""A copy of the project in which everything has run, shared by what looks at rules and faults."""

import pytest

from ..conftest import alone
from .project import Project


@pytest.fixture(scope="session")
def project(shared, tmp_path_factory):
    """Tests put back what they change; ``results`` are the bytes of the undisturbed run."""
    folder, output = shared / "a folder with 'quotes'", shared / "project.txt"
    with alone(folder):
        if not output.exists():
            made = Project(folder)
            status, said = made.run()
            assert status == 0, said
            output.write_text(said)
    made = Project.at(folder).copy(tmp_path_factory.mktemp("project") / folder.name)
    made.said = output.read_text()
    made.undisturbed = made.results()
    return made
