"""Robots of many joints: what Pinocchio takes for them is foreseen, and refused where there is not enough."""

import math
import subprocess
import sys
from pathlib import Path

import pinocchio as pin
import pytest

from spear_pin.errors import BadFile
from spear_pin.model import memory
from spear_pin.model.loading import load

LINK = (
    '<link name="l{0}"><inertial><mass value="1"/>'
    '<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/></inertial></link>'
)
JOINT = (
    '<joint name="j{0}" type="continuous"><origin xyz="0 0 -0.1"/><axis xyz="0 1 0"/>'
    '<parent link="l{0}"/><child link="l{1}"/></joint>'
)


@pytest.fixture
def chain(tmp_path):
    """The path of a chain of so many joints."""

    def written(joints):
        links = "".join(LINK.format(i) for i in range(joints + 1))
        path = tmp_path / "chain.urdf"
        path.write_text(f'<robot name="c">{links}{"".join(JOINT.format(i, i + 1) for i in range(joints))}</robot>')
        return path

    return written


def test_a_robot_is_refused_before_it_takes_the_memory(chain, monkeypatch):
    path = chain(200)
    monkeypatch.setattr(memory, "free_memory", lambda: 2e9)
    monkeypatch.setattr(pin, "Data", lambda model: pytest.fail("it was taken"))
    with pytest.raises(BadFile, match=r"200 joints .* 288\.0 MB of memory: more than 10% of the 2\.0 GB that are free"):
        load(path)


def test_what_there_is_enough_for_is_loaded(chain, monkeypatch):
    monkeypatch.setattr(memory, "free_memory", lambda: 1e9)
    assert load(chain(60), base="fixed", motors=[]).nv == 60


@pytest.mark.slow
@pytest.mark.skipif(not Path("/proc/self/status").is_file(), reason="no /proc here")
def test_no_more_is_taken_than_is_foreseen(chain):
    """Nor for a moment: `Model.createData` would make two copies."""
    code = f"""
import re
from spear_pin.model import loading
peak = lambda: 1024 * int(re.search(r"VmHWM:\\s+(\\d+)", open("/proc/self/status").read())[1])
before = peak()
robot = loading.load({str(chain(200))!r}, base="fixed", motors=[])
print(peak() - before)
"""
    taken = int(subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout)
    assert taken == pytest.approx(memory.CUBIC * 200**3 + memory.SQUARE * 200**2, rel=0.1)


def test_the_free_memory(tmp_path, monkeypatch):
    path = tmp_path / "meminfo"
    monkeypatch.setattr(memory, "MEMINFO", path)
    assert 1e8 < memory.free_memory() <= math.inf  # of a system that has no such file
    path.write_text("MemTotal:       24000000 kB\nMemAvailable:    2000000 kB\n")
    assert memory.free_memory() == 2.048e9
