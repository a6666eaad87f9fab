"""What ships: every file of the tree, and the two folders that live beside it."""

import os
import subprocess
import sys
import tomllib
from fnmatch import fnmatch
from importlib import metadata
from importlib.resources import files
from pathlib import Path

import pytest

from spear_pin import __version__
from spear_pin.model.loading import ROBOTS

ROOT = Path(__file__).parents[1]
SETUPTOOLS = tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["setuptools"]


def test_every_file_ships_with_a_listed_package():
    packages = {package.replace(".", "/"): package for package in SETUPTOOLS["packages"]}
    found = set()
    for folder, _, names in os.walk(ROOT / "spear_pin", followlinks=True):
        for name in names if "__pycache__" not in folder else []:
            path = (Path(folder) / name).relative_to(ROOT)
            home = next(parent for parent in path.parents if parent.as_posix() in packages)
            package = packages[home.as_posix()]
            found.add(package)
            is_module = path.parent == home and path.suffix == ".py"
            patterns = SETUPTOOLS["package-data"].get(package, [])
            inside = path.relative_to(home).as_posix()
            assert is_module or any(fnmatch(inside, pattern) for pattern in patterns), f"{path} would not ship"
    assert found == set(SETUPTOOLS["packages"])


@pytest.mark.parametrize(("package", "folder"), SETUPTOOLS["package-dir"].items())
def test_the_symlink_of_a_folder_leads_where_its_package_comes_from(package, folder):
    link = ROOT.joinpath(*package.split("."))
    assert link.is_symlink() and not os.path.isabs(os.readlink(link))
    assert link.resolve() == (ROOT / folder).resolve()


def test_the_urdfs_are_reached_as_resources():
    shipped = {file.name for file in files("spear_pin.urdf").iterdir() if file.name.endswith(".urdf")}
    assert shipped == {robot.file for robot in ROBOTS.values()}


def test_the_package_runs_as_a_module():
    run = subprocess.run([sys.executable, "-m", "spear_pin", "--help"], cwd=ROOT, capture_output=True, text=True)
    assert run.returncode == 0, run.stderr
    assert "usage" in run.stdout


def test_the_version_is_written_once():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    assert "version" not in project and project["dynamic"] == ["version"]
    assert SETUPTOOLS["dynamic"]["version"] == {"attr": "spear_pin.__version__"}
    assert metadata.version("spear-pin") == __version__
