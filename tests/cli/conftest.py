"""Somebody else's robots, and a laboratory's log, written to disk."""

import numpy as np
import pytest

from spear_pin import load
from spear_pin.model.loading import ROBOTS
from tests.model.legged import quadruped
from tests.studies.logs.crank_leg import configured, spring, synthetic


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


@pytest.fixture(scope="session")
def laboratory(tmp_path_factory):
    """A folder with hops.csv, a log of a spring of 400 N/m in a laboratory's units, names and stamps, and leg.toml."""
    folder, robot = tmp_path_factory.mktemp("laboratory"), load("crank_hopper")
    log, _ = synthetic(configured(robot, springs={"leg": spring()}))
    angles = np.degrees(log["crank"] + np.random.default_rng(1).normal(0.0, 1e-4, len(log.t)))
    rows = [
        f"{1717444672123456789 + round(1e9 * time)};{angle:.5f};{1e3 * torque / robot.gear_ratio('crank'):.3f};25"
        for time, angle, torque in zip(log.t.tolist(), angles, log["crank_torque"], strict=True)
    ]
    text = "\n".join(["# SYNTHETIC", "stamp;theta_deg;drive_mNm;temperature", *rows, ""])
    (folder / "hops.csv").write_text(text, encoding="utf-8")
    shipped = ROBOTS["crank_hopper"].path.with_suffix(".toml").read_text(encoding="utf-8")
    (folder / "leg.toml").write_text(f'robot = "crank_hopper"\n{shipped}\nunilateral = false\n', encoding="utf-8")
    return folder


@pytest.fixture
def lab(laboratory, monkeypatch):
    """That folder as the current one, with a file that says what its columns are."""
    monkeypatch.chdir(laboratory)
    (laboratory / "hops.toml").write_text(
        '[columns]\ntime = "stamp"\ncrank = "theta_deg"\ncrank_torque = { column = "drive_mNm", at = "motor" }\n',
        encoding="utf-8",
    )
    return laboratory
