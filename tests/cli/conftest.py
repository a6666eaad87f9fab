"""Somebody else's robots, written to disk."""

import pytest

from tests.model.legged import quadruped


@pytest.fixture(scope="session")
def dog(tmp_path_factory):
    path = tmp_path_factory.mktemp("robots") / "dog.urdf"
    path.write_text(quadruped(), encoding="utf-8")
    return path


@pytest.fixture(scope="session")
def blank(tmp_path_factory):
    """One whose knees may flex to either side."""
    path = tmp_path_factory.mktemp("robots") / "blank.urdf"
    path.write_text(quadruped(knee_limits=(-2.5, 2.5)), encoding="utf-8")
    return path
