"""URDFs and MJCF files written to disk, and the arm in three dimensions."""

import pytest

from spear_pin.model.loading import load
from tests.model.spatial_arm import ARM


@pytest.fixture
def write(tmp_path):
    """A function that writes a URDF, text or bytes, and returns its path."""

    def write(text):
        path = tmp_path / "arm.urdf"
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return path

    return write


@pytest.fixture
def arm(write):
    """The arm that yaws and pitches, its foot a toe."""
    return load(write(ARM), toes=["foot"])


@pytest.fixture
def write_xml(tmp_path):
    """A function that writes a file beside others, and returns its path."""

    def write(text, name="dog.xml"):
        path = tmp_path / name
        path.parent.mkdir(exist_ok=True)
        path.write_text(text, encoding="utf-8")
        return path

    return write
