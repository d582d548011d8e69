"""A copy of the project in which everything has run, shared by what looks at rules and faults."""

import pytest

from .project import Project


@pytest.fixture(scope="session")
def project(tmp_path_factory):
    """Tests put back what they change; ``results`` are the bytes of the undisturbed run."""
    made = Project(tmp_path_factory.mktemp("project") / "a folder with 'quotes'")
    status, output = made.run()
    assert status == 0, output
    made.said = output
    made.undisturbed = made.results()
    return made
