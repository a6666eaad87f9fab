"""Many lanes at once by the Taylor engine, each against the reference engine."""

import sys
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pytest

from spear_pin import Contact, Gait, HoppingLaw, Spring, find_gait, hopping
from spear_pin.errors import BadValue, MissingExtra, UnknownName
from spear_pin.hybrid.batch import simulate_many
from spear_pin.hybrid.dry_friction import with_dry_friction
from spear_pin.hybrid.parameters import with_hardware
from spear_pin.hybrid.result import Options
from spear_pin.hybrid.run import run
from spear_pin.model.boom import on_rotary_boom
from spear_pin.studies.hardware import Rig
from tests.hybrid.lanes import around, assert_agree, compiles


@dataclass(frozen=True)
class Listing(HoppingLaw):
    """A law with a field of any kind."""

    gains: Any = ()


@compiles
class TestAgainstTheReference:
    def test_near_the_hop(self, hop):
        q, v = around(hop, 0.01, 20)
        found = simulate_many(hop.system, q, v)
        assert not found.repeated.any()
        assert_agree(hop.system, q, v, found)

    def test_further_away(self, hop):
        """Slip, slack springs, lift-off at a switch of the torque, motion on the switching surface."""
        q, v = around(hop, 0.1, 24)
        found = simulate_many(hop.system, q, v)
        assert not found.repeated.any()
        slid = [
            any("chatter" in event.domain for event in run(hop.system, state, 1, Options()).events)
            for state in zip(q, v, strict=True)
        ]
        assert sum(slid) > 2
        assert_agree(hop.system, q, v, found)

    def test_several_cycles(self, hop):
        q, v = around(hop, 0.02, 6)
        assert_agree(hop.system, q, v, simulate_many(hop.system, q, v, 3), 3)

    def test_free_to_move_forward(self, free_hop):
        q, v = around(free_hop, 0.02, 10)
        assert_agree(free_hop.system, q, v, simulate_many(free_hop.system, q, v))

    def test_from_the_air_and_falling(self, free_hop):
        """Some topple over."""
        rng = np.random.default_rng(5)
        bounds = [(0.0, 0.0), (0.7, 0.9), (0.0, 1.0), (0.6, 1.4)]
        q = np.column_stack([rng.uniform(*bound, 12) for bound in bounds])
        v = rng.uniform(-0.5, 0.5, (12, 4))
        found = simulate_many(free_hop.system, q, v)
        assert set(found.reason) >= {"complete", "fall"}
        assert_agree(free_hop.system, q, v, found)

    def test_each_lane_with_its_own_numbers(self, hop):
        """Of law, spring and ground."""
        q, v = around(hop, 0.005, 8)
        rng = np.random.default_rng(6)
        values = {
            "stance_torque": rng.uniform(6, 10, 8),
            "stiffness": rng.uniform(40, 60, 8),
            "damping": rng.uniform(0.8, 1.6, 8),
            "friction": rng.uniform(0.5, 1.0, 8),
            "frequency": rng.uniform(2.3, 2.8, 8),
        }
        found = simulate_many(hop.system, q, v, parameters=values)
        assert_agree(hop.system, q, v, found, parameters=values)

    @pytest.mark.slow
    def test_bound(self):
        gait = Gait.load("long_stride")
        q, v = around(gait, 2e-4, 16)
        found = simulate_many(gait.system, q, v)
        assert not found.repeated.any()
        assert_agree(gait.system, q, v, found)

    def test_limited_flexion(self, robot, hop):
        """A law that asks for forces, with its own events, one of them where it bends."""
        system = hopping(robot, HoppingLaw(stance_torque=10.0, minimum_force=15.0))
        q, v = around(hop, 0.02, 8)
        found = simulate_many(system, q, v)
        assert not found.repeated.any()
        assert_agree(system, q, v, found)

    def test_fixed_spring(self, robot, hop):
        system = hopping(robot, hop.system.law, Spring(rest=1.0))
        q, v = around(hop, 0.1, 16)
        found = simulate_many(system, q, v)
        assert not found.repeated.any()
        assert_agree(system, q, v, found)

    def test_springs_that_differ_from_the_systems(self, hop):
        """A mount with numbers of its own, and one like it: neither is taken for the other, nor for the system's."""
        q, v = around(hop, 0.01, 3)
        for stiffness, damping in ((40.0, 1.3), (44.0, 1.3), (48.84, 0.9)):
            domains = tuple(
                replace(domain, mounts=tuple(replace(m, spring=Spring(stiffness, damping)) for m in domain.mounts))
                for domain in hop.system.domains
            )
            system = replace(hop.system, domains=domains)
            assert_agree(system, q, v, simulate_many(system, q, v))

    def test_laws_that_close_over_numbers(self, hop):
        """Two of the same place in the code."""
        q, v = around(hop, 0.01, 3)

        def weaker(domain, share):
            return replace(domain, law=lambda *given: [share[0] * torque for torque in domain.law(*given)])

        for share in ([0.97], [1.02]):
            system = replace(hop.system, domains=tuple(weaker(domain, share) for domain in hop.system.domains))
            assert_agree(system, q, v, simulate_many(system, q, v))

    def test_linear_spring(self, robot, hop):
        system = hopping(robot, hop.system.law, Spring(unilateral=False), Contact(0.6))
        q, v = around(hop, 0.02, 6)
        assert_agree(system, q, v, simulate_many(system, q, v))


class TestBadInput:
    @pytest.mark.parametrize(
        ("q", "v", "name"),
        [
            (np.zeros((2, 4)), np.zeros((2, 3)), "q"),
            (np.zeros(3), np.zeros((1, 3)), "q"),
            (np.zeros((2, 3)), np.full((2, 3), np.nan), "v"),
            (np.zeros((2, 3)), np.zeros((3, 3)), "v"),
        ],
    )
    def test_states(self, hop, q, v, name):
        with pytest.raises(BadValue, match=f"^{name} is "):
            simulate_many(hop.system, q, v)

    @pytest.mark.parametrize("cycles", [0, 1.5])
    def test_cycles(self, hop, cycles):
        with pytest.raises(BadValue, match="^cycles is "):
            simulate_many(hop.system, *np.zeros((2, 1, 3)), cycles)

    def test_parameters(self, hop):
        states = np.zeros((2, 2, 3))
        with pytest.raises(UnknownName, match="stiffnes"):
            simulate_many(hop.system, *states, parameters={"stiffnes": [1.0, 2.0]})
        with pytest.raises(BadValue, match="^Spring.stiffness is -1"):
            simulate_many(hop.system, *states, parameters={"stiffness": [1.0, -1.0]})
        with pytest.raises(BadValue, match=r"^parameters\['stiffness'\] is "):
            simulate_many(hop.system, *states, parameters={"stiffness": [1.0]})

    def test_what_cannot_be_compiled(self, robot, hop):
        others = with_hardware(hop.system, Rig().on(robot)), with_dry_friction(hop.system, {"boom_z": 5.0})
        for system in (*others, hopping(on_rotary_boom(robot))):
            with pytest.raises(BadValue, match="^(system|robot) is "):
                simulate_many(system, *np.zeros((2, 1, 3)))

    @compiles
    @pytest.mark.parametrize("value", [[1.0, 2.0], {"a": 1.0}, (1.0, [2.0])], ids=str)
    def test_a_law_that_keeps_lists(self, robot, value):
        system = hopping(robot, Listing(hip_touchdown=0.5, stance_torque=8.0, gains=value))
        with pytest.raises(BadValue, match="Listing.gains is .* or a tuple or a dataclass of these"):
            simulate_many(system, *(part[None] for part in system.guess()))

    def test_a_law_that_keeps_a_list_is_searched_by_differences(self, robot, hop):
        system = hopping(robot, Listing(hip_touchdown=0.5, stance_torque=8.0, gains=[1.0]))
        found = find_gait(system, ["stance_torque"], {"flight_time": 0.2}, guess=hop.state)
        assert found.system.law.gains == [1.0] and np.abs(found.multipliers).max() < 1.0

    def test_without_the_extra(self, hop, monkeypatch):
        monkeypatch.setitem(sys.modules, "heyoka", None)
        with pytest.raises(MissingExtra, match=r"\.\[fast\]"):
            simulate_many(hop.system, np.array([hop.state[0]]), np.array([hop.state[1]]))
