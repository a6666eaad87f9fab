"""Why a hop was not found, and one thing to try, from the system and the farthest cycle of the search."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Mapping
from typing import Any, NamedTuple

from spear_pin.errors import NoGait, SpearError
from spear_pin.gaits.proportions import usual_flight
from spear_pin.gaits.targets import FLIGHT
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.contact import Contact
from spear_pin.hybrid.periodic import return_map
from spear_pin.hybrid.reasons import NUMERICAL
from spear_pin.hybrid.result import State
from spear_pin.model.limits import UNKNOWN
from spear_pin.model.scale import Scale, scale_of

KIND = "hopping"  # kind of the systems that can be diagnosed
HOPPING = "spear_pin.gaits.hopping"  # where their laws stand
ASIDE = 0.35  # rad: between the line from hip to toe at touchdown and straight down
OFF = 2.0  # factor between a number and SPEAR-II's scaled one
SWITCHED = 1e-6  # share of a period: the square wave ends a stance that ends so near to its end
DAMPING = "damping of the spring"
HARMLESS = {"friction": 1, DAMPING: -1}  # to which side a number may be far off
LONGER, FARTHER = 1.25, 1.5  # factors over the wanted flight time, and over the last one found
COARSE = 1e-8  # relative tolerance of the cycle that is looked at


class Reached(NamedTuple):
    """How far a continuation came: the share of the way to the targets, and the fixed point there."""

    share: float
    system: HybridSystem
    state: State


class Diagnosis(NamedTuple):
    """The likely cause, and one thing to try, each in words."""

    cause: str
    remedy: str


class _Case(NamedTuple):
    system: HybridSystem
    vary: Collection[str]
    target: Mapping[Any, float]
    reached: Reached | None
    law: Any  # SPEAR-II's law, scaled to the robot, like `spring`
    spring: Any


def explain_failure(
    failure: NoGait,
    system: HybridSystem,
    vary: Collection[str],
    target: Mapping[Any, float],
    reached: Reached | None = None,
) -> NoGait:
    """Returns the failure of a search; for a hop it adds the cause and what to try, where these are known.

    Args:
        failure: failure of the search.
        system: the system with the parameters with which the search began.
        vary: names of the parameters that it varied.
        target: wanted values of measures.
        reached: the farthest point of its continuation.
    """
    if system.kind != KIND or not _led_by_its_own(system):
        return failure
    try:
        found = diagnosis(system, vary, target, reached)
    except SpearError:  # a robot of which nothing can be told
        return failure
    return failure if found is None else NoGait(failure.reason, failure.residual, *found)


def diagnosis(
    system: HybridSystem, vary: Collection[str], target: Mapping[Any, float], reached: Reached | None = None
) -> Diagnosis | None:
    """Lists causes that speak against a hop, the most certain first; see `explain_failure` for the arguments.

    Raises:
        BadValue: the robot does not have one leg with SPEAR-II's signs.
    """
    from spear_pin.gaits.hopping import HoppingLaw
    from spear_pin.model.spring import Spring

    turned = _knee_side(system)
    if turned is not None:
        return turned
    case = _Case(system, vary, target, reached, HoppingLaw.scaled(system.robot), Spring.scaled(system.robot))
    return next((found for test in TESTS if (found := test(case)) is not None), None)


def _led_by_its_own(system: HybridSystem) -> bool:
    """Tells whether the hop's own laws lead it, not one that somebody has put into a domain."""
    return all(domain.law.__module__ == HOPPING for domain in system.domains)


def _knee_side(system: HybridSystem) -> Diagnosis | None:
    """Diagnoses a knee that flexes to the other side, or axes and zeros that are not SPEAR-II's."""
    legs = system.robot.legs
    if len(legs) != 1:
        return None
    leg = legs[0]
    if leg.knee_sign < 0 or leg.side < 0:
        cause = f"the knee {leg.knee!r} flexes to negative angles, and the law to positive ones"
        return Diagnosis(cause, f"monopod(robot, {leg.name!r}) in place of the robot: it turns the axis")
    if leg.hip_sign < 0:
        cause = f"the axis of the hip {leg.hip!r} points the other way than SPEAR-II's, for which the law is written"
        return Diagnosis(cause, f"monopod(robot, {leg.name!r}) in place of the robot: it turns the axis")
    if system.law.knee_touchdown <= 0:
        cause = f"the knee lands at {system.law.knee_touchdown:.3g} rad, straight or bent to the wrong side"
        return Diagnosis(cause, f"knee_touchdown={abs(system.law.knee_touchdown) or 1.0:.3g}")
    return None


def _toe_aside(case: _Case) -> Diagnosis | None:
    """Diagnoses a toe that is not below the hip at touchdown."""
    law, (leg,) = case.system.law, case.system.robot.legs
    own = leg.lean(law.knee_touchdown)
    hip, aside = law.hip_commanded, law.hip_commanded - own
    if abs(aside) < ASIDE or "hip_touchdown" in case.vary:
        return None
    where = leg.length(law.knee_touchdown) * math.sin(aside)
    cause = (
        f"the toe lands {abs(where):.2g} m {'before' if where > 0 else 'behind'} the hip, commanded to {hip:.3g} rad"
    )
    return Diagnosis(cause, f"hip_touchdown={own:.3g}, with which it lands below")


def _off_scale(case: _Case) -> Diagnosis | None:
    """Diagnoses a number that is far from SPEAR-II's, scaled."""
    law, spring, friction = case.system.law, case.system.spring, case.system.contact.friction
    pairs = {"friction": (friction, Contact().friction, "")}
    for name in ("stance_torque", "frequency", "knee_touchdown", "hip_gain", "knee_gain"):
        pairs[name] = getattr(law, name), getattr(case.law, name), case.law.units[name]
    if spring.path is None:
        pairs[DAMPING] = spring.damping, case.spring.damping, "N·m·s/rad"
    if case.reached is None and FLIGHT in case.target:
        pairs["flight_time"] = case.target[FLIGHT], usual_flight(case.system.robot), "s"
    if not spring.table and spring.path is None:
        pairs["stiffness"] = spring.stiffness + law.virtual_stiffness, case.spring.stiffness, "N·m/rad"
    ratios = {
        name: own / usual
        for name, (own, usual, _) in pairs.items()
        if (name not in case.vary or case.reached is None) and (own - usual) * HARMLESS.get(name, 0) <= 0
    }
    worst = max(ratios, key=lambda name: abs(math.log(max(ratios[name], 1e-9))))
    if 1.0 / OFF < ratios[worst] < OFF:
        return None
    own, usual, unit = pairs[worst]
    own_size = case.system.robot.reach is None and scale_of(case.system.robot) == Scale(1.0, 1.0, 1.0)
    scaled = "SPEAR-II's" if own_size else "SPEAR-II's, scaled to this leg"
    times = f"{ratios[worst]:.2g} times" if own else "far from"
    name, key = worst.replace("_", " "), worst.partition(" ")[0]
    return Diagnosis(f"the {name} of {f'{own:.3g} {unit}'.strip()} is {times} {scaled}", f"{key}={usual:.3g}")


def _gap(case: _Case) -> Diagnosis | None:
    """Diagnoses a continuation to a flight time that ended where the square wave ends stance."""
    if case.reached is None or FLIGHT not in case.target or case.reached.share >= 1.0:
        return None
    cycle = return_map(case.reached.system, case.reached.state, COARSE)
    if not cycle.cycles:
        return None
    law, stance, flight = case.reached.system.law, cycle.durations["stance"], cycle.durations["flight"]
    wanted, period = case.target[FLIGHT], 1.0 / law.frequency
    way = (
        f"flights towards {wanted:.3g} s end at {flight:.3g} s"
        if case.reached.share
        else f"the nearest flight to {wanted:.3g} s is {flight:.3g} s"
    )
    way += f", with {law.stance_torque:.3g} N·m{_of_limit(case)}"
    near = case.reached.share > 0.0 or wanted < FARTHER * flight
    if near and abs(stance - period) < SWITCHED * period:
        cause = f"{way}: there the square wave turns back after its {period:.3g} s and ends stance, a gap in the hops"
        if wanted > flight:
            beyond = FARTHER * flight if wanted > FARTHER * flight else LONGER * wanted
            return Diagnosis(cause, f"a flight time of {beyond:.2g} s")
        return Diagnosis(cause, f"a flight time of {_below(flight)} s")
    return Diagnosis(
        way, f"stance_torque={_below(law.stance_torque)}, with which it flies as long, or another stiffness"
    )


def _below(value: float) -> str:
    """Formats a number > 0, rounded down to three digits: smaller values were reached on the way."""
    digits = 2 - math.floor(math.log10(value))
    return f"{math.floor(value * 10.0**digits) / 10.0**digits:g}"


def _of_limit(case: _Case) -> str:
    """Says how the torque that was reached compares with the knee's limit, where it is larger."""
    limit = case.system.robot.limits["knee"].effort
    torque = (case.system if case.reached is None else case.reached.system).law.stance_torque
    return f", {torque / limit:.2g} times the knee's limit" if 0.0 < limit < min(torque, UNKNOWN) else ""


def _torque(case: _Case) -> Diagnosis | None:
    """Diagnoses a stance torque that the joint cannot have."""
    said = _of_limit(case)
    if not said:
        return None
    law, limit = case.system.law, case.system.robot.limits["knee"].effort
    return Diagnosis(f"the stance torque is {law.stance_torque:.3g} N·m{said}", f"stance_torque={limit:.3g}")


def _ended(case: _Case) -> Diagnosis | None:
    """Diagnoses a first cycle that breaks off."""
    system = case.system
    cycle = return_map(system, system.guess(), COARSE)
    if cycle.cycles or cycle.reason in NUMERICAL:
        return None
    cause = f"the first hop ends in {cycle.domain.phase}: {cycle.message}"
    if cycle.reason == "no_event" and cycle.domain.phase == "stance":
        return Diagnosis(cause, f"stance_torque={FARTHER * system.law.stance_torque:.3g}")
    return Diagnosis(cause, "fewer changes to what HoppingLaw.scaled and Spring.scaled give")


TESTS: tuple[Callable[[_Case], Diagnosis | None], ...] = (_toe_aside, _off_scale, _gap, _torque, _ended)
