"""Cards of what a notebook shows: what they say is so, and they may stand in any page."""

import re
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from lxml import etree, html

from spear_pin import Gait, load, simulate
from spear_pin.gaits.gait_table import GaitTable
from spear_pin.hybrid.batch import Batch
from spear_pin.studies.logs import Found, Hop, Log, LogPhase, MotionFit, Replay
from spear_pin.viz.notebook import card
from tests.viz.samples import ODD


def rows(text):
    """Names and values, in the order of the card."""
    found = html.fromstring(text).xpath("//tr")
    return {row.xpath("string(th)").strip(): " ".join(row.xpath("string(td[1])").split()) for row in found}


def drawings(text):
    """The drawings, by what they say they show."""
    return {each.get("aria-label"): each for each in etree.HTML(text).xpath("//svg")}


def table(n=4):
    multipliers = np.array([[0.5 + 0j], [1.2 + 0j], [0.9j], [np.nan + 0j]])
    reason = np.array(["converged", "converged", "converged", "fall"])
    stiffness = np.array([40.0, 50.0, 60.0, 70.0])
    state = np.zeros((n, 3))
    return GaitTable(state, state, {"stiffness": stiffness}, np.zeros(n), multipliers, {"flight": state[:, 0]}, reason)


def batch():
    reason, state = np.array(["complete", "complete", "fall"]), np.zeros((3, 3))
    cycles, repeated = np.array([5, 5, 2]), np.array([False, False, True])
    return Batch(state, state, cycles, reason, ("", "", ""), {"flight": np.array([0.1, 0.2, np.nan])}, {}, repeated)


def test_a_fit_to_logs():
    found = {"stiffness": Found(1386.2, 12.34, "N/m"), "torque_scale": Found(0.95, 0.01, "1")}
    leg = SimpleNamespace(robot=load("crank_hopper"))
    fit = MotionFit(
        None, None, leg, ("slide",), found, None, (None,) * 3, (), (), 0.0021, 1.0, (), ("masses were held",), True, 9
    )
    assert rows(fit._repr_html_()) == {
        "stiffness": "1386 ± 12.34 N/m",
        "torque scale": "0.95 ± 0.01",
        "residual": "0.0021 rad, lengths weighted",
        "": "masses were held",
    }


def test_a_replay():
    measures = {"compression": (0.02, 0.025), "stance": (0.2, 0.2), "push_off": (1.1, 1.0)}
    hop = Hop(LogPhase("stance", 0.5, 0.7, True), np.zeros(2), np.zeros((2, 1)), np.zeros((2, 1)), 0.7, measures)
    replay = Replay(Log("hop", np.arange(2.0), {}), ("crank",), ("rad",), (hop,), ())
    assert list(rows(replay._repr_html_()).items())[::2] == [
        ("compression from 0.500 s", "0.02; in the log 0.025 m"),
        ("push off from 0.500 s", "1.1; in the log 1 m/s"),
        ("stance, off on average", "0 %"),
    ]


class TestWhatTheySay:
    def test_robot(self, robot):
        text = robot._repr_html_()
        assert rows(text) == {
            "mass": "6.8 kg",
            "coordinates": "boom_z (m), hip (rad), knee (rad)",
            "motors": "hip (60 : 1), knee (15 : 1)",
            "toes": "toe",
            "locked": "boom_x",
        }
        assert list(drawings(text)) == ["spear_ii from its side, its knees bent"]

    @pytest.mark.slow
    def test_a_motion_in_space_has_its_normal_forces(self):
        gait = Gait.load(Path(__file__).parents[3] / "examples" / "turn.json")
        stride = simulate(gait.system, gait.state, progress=False)
        assert rows(card(stride))["force_z_posterior_left_toe"] == f"0 to {stride.force[:, 0, 2].max():.4g} N"

    @pytest.mark.parametrize("name", ["q_spear", "q_spear_full"])
    def test_other_robots(self, name):
        text = card(load(name))
        assert rows(text)["mass"].endswith(" kg") and "60 : 1" in rows(text)["motors"]
        _, bones, joints = drawings(text)[f"{name} from its side, its knees bent"].xpath("path/@d")
        assert bones.count("L") == joints.count("M") == 3 * len(load(name).toes)  # trunk, thigh and shank

    def test_gait(self, gait):
        text = gait._repr_html_()
        said = rows(text)
        assert said["stance torque"] == "8 N·m" and said["period"] == "0.56 s" and said["residual"] == "1.0e-12"
        assert said["flight"] == "0.2 s" and said["largest multiplier"] == "0.4123, stable"
        assert "Floquet multipliers and the unit circle" in drawings(text)

    def test_motion(self, hops):
        text = hops._repr_html_()
        said = rows(text)
        assert said["cycles"] == "4 whole" and "4 apex" in said["events"]
        low, high = hops.q[:, 2].min(), hops.q[:, 2].max()
        assert said["q_knee"] == f"{low:.4g} to {high:.4g} rad"
        assert said["force_z_toe"].startswith("0 to ") and said["force_z_toe"].endswith(" N")
        assert {"knee over time", "toe over time"} <= set(drawings(text)) and "ended" not in said

    def test_motion_that_ended(self, hops):
        assert rows(card(replace(hops, reason="fall", message="it fell")))["ended"] == "it fell"

    def test_gaits_of_many_lanes(self):
        text = table()._repr_html_()
        said = rows(text)
        assert said["converged"] == "3" and said["fall"] == "1" and said["stable"] == "2"
        assert said["stiffness"] == "40 to 70 N·m/rad" and said["largest multiplier"] == "0.5 to 1.2"
        assert repr(table()) == "GaitTable(4 lanes: 3 gaits found, 2 stable)"

    def test_no_gait_of_many_lanes(self):
        nothing = replace(table(), multipliers=np.full((4, 1), np.nan + 0j), reason=np.full(4, "fall"))
        assert rows(card(nothing))["largest multiplier"] == "none"

    def test_runs_of_many_lanes(self):
        said = rows(batch()._repr_html_())
        assert said["complete"] == "2" and said["fall"] == "1" and said["flight"] == "0.1 to 0.2 s"
        assert repr(batch()) == "Batch(3 lanes: 2 complete, 1 fall)"


class TestDrawings:
    def test_multipliers_outside_the_circle_are_crosses(self):
        gait = Gait.load("long_stride")
        circles, crosses = drawings(card(gait))["Floquet multipliers and the unit circle"].xpath("path")[2:]
        outside = int((np.abs(gait.multipliers) >= 1.0).sum())
        assert circles.get("d").count("M") == len(gait.multipliers) - outside
        assert crosses.get("d").count("M") == outside == 1

    def test_are_of_finite_numbers(self, gait, hops, robot):
        for text in (card(gait), card(hops), card(robot), card(table())):
            for svg in drawings(text).values():
                for path in svg.xpath("path/@d"):
                    assert np.isfinite([float(number) for number in re.findall(r"-?[\d.]+", path)]).all()

    def test_are_small(self, hops):
        assert len(card(hops)) < 16_000


def test_a_name_is_no_markup(hops):
    assert ODD not in card(replace(hops, robot=ODD))
    assert html.fromstring(card(replace(hops, robot=ODD))).xpath("string(//b)") == f"Motion of {ODD}"


@pytest.mark.slow
def test_nothing_is_drawn_until_it_is_shown():
    drawing = {"matplotlib", "jinja2", "pandas", "spear_pin.viz"}
    script = f"import sys; from spear_pin import Gait, Robot, Trajectory; print({drawing} & set(sys.modules))"
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "set()"
