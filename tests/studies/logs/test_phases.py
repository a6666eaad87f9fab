"""Stance and flight in a log: found from the leg's motion alone, beside the events of the simulation."""

from dataclasses import replace

import numpy as np
import pytest

from spear_pin import hopping, load, simulate
from spear_pin.errors import BadFile, BadValue, UnknownName
from spear_pin.studies.logs import Log, find_phases
from tests.studies.logs.crank_leg import two_joints

NEAR = 0.002  # s


def test_are_those_of_the_simulation(crank, plain_log):
    log, trajectory = plain_log
    events = [event.time for event in trajectory.events if event.name in ("touchdown", "lift_off")]
    found = find_phases(crank, log)
    assert [phase.name for phase in found] == ["stance", "flight"] * 3
    assert [phase.end for phase in found[:-1]] == pytest.approx(events[:-1], abs=NEAR)
    assert [phase.whole for phase in found] == [False, True, True, True, True, False]
    assert not any(phase.left_out for phase in found)


def test_a_leg_that_slows_down_before_it_lifts_off():
    """SPEAR-II, whose leg lengthens fastest long before."""
    robot = load("spear_ii", locked=["boom_x"])
    system = hopping(robot)
    run = simulate(system, system.guess(), 3, samples=400, progress=False)
    found = find_phases(robot, two_joints(run))
    events = [event.time for event in run.events if event.name in ("touchdown", "lift_off")]
    assert [phase.name for phase in found] == ["stance", "flight"] * 3
    assert [phase.end for phase in found[:-1]] == pytest.approx(events[:-1], abs=2.5 * NEAR)


def test_a_gap_leaves_its_phase_out(crank, plain_log):
    log, _ = plain_log
    kept = (log.t < 0.48) | (log.t > 0.5)
    holed = Log(log.source, log.t[kept], {name: each[kept] for name, each in log.values.items()})
    reasons = [phase.left_out for phase in find_phases(crank, holed)]
    assert reasons[2] == "22 ms have no sample"
    assert not any(reasons[:2] + reasons[3:])


def test_a_leg_that_is_drawn_in_while_it_still_rises_has_not_landed(crank, plain_log):
    log, trajectory = plain_log
    lift_off = next(event.time for event in trajectory.events if event.name == "lift_off")
    drawn = log["crank"] + 0.1 * np.exp(-(((log.t - lift_off - 0.06) / 0.015) ** 2))
    assert [phase.name for phase in find_phases(crank, replace(log, values={"crank": drawn}))] == [
        "stance",
        "flight",
    ] * 3


def test_refuses_what_is_no_hop(crank, plain_log):
    log, _ = plain_log
    with pytest.raises(BadFile, match="it has no hop"):
        find_phases(crank, replace(log, values={"crank": np.zeros_like(log.t)}))
    slow = Log("slow", log.t[::10], {"crank": log["crank"][::10]})
    with pytest.raises(BadFile, match="samples are 0.01 s apart; a hop needs 0.006 s or less"):
        find_phases(crank, slow)
    with pytest.raises(BadValue, match="positions of more joints"):
        find_phases(load("spear_ii", locked=["boom_x"]), replace(log, values={"knee": log["crank"]}))
    with pytest.raises(UnknownName, match="joint of crank_hopper in the log synthetic"):
        find_phases(crank, replace(log, values={"ankle": log["crank"]}))
    with pytest.raises(BadValue, match="a planar robot with one toe"):
        find_phases(load("q_spear"), log)
