"""A controller in C, compiled and called from Python."""

import ctypes
import re
import subprocess
from dataclasses import replace
from functools import partial

from spear_pin import Gait, HoppingLaw, hopping, load, simulate
from spear_pin.hybrid.controller import happenings
from spear_pin.viz.controller.writing import write_controller

COMPILE = "gcc", "-O2", "-std=c99", "-Wall", "-Wextra", "-Wconversion", "-Werror", "-pedantic"


def hop(law=None, cycles=30):
    """SPEAR-II's hop that its own law leads to; with the default one a flight of 0.2 s."""
    system = hopping(load("spear_ii", locked=["boom_x"]), law or HoppingLaw(stance_torque=7.826187875301223))
    last = simulate(system, system.guess(), cycles=cycles, rtol=1e-10).events[-1]
    return Gait(system, (last.q, last.v), {}, 0.0, [0.0], {"stance": 0.364, "flight": 0.2})


def array(values):
    values = [float(value) for value in values]
    return (ctypes.c_double * len(values))(*values)


class Compiled:
    """The controller of a gait, written into a folder and compiled."""

    def __init__(self, gait, folder):
        write_controller(gait, folder)
        subprocess.run([*COMPILE, "-shared", "-fPIC", "controller.c", "-o", "c.so", "-lm"], cwd=folder, check=True)
        header = (folder / "controller.h").read_text()
        sizes = {name: int(value) for name, value in re.findall(r"#define (SPEAR_\w+) (\d+)\n", header)}
        self.events = re.findall(r"^  (SPEAR_\w+),?$", header.partition("SPEAR_NOTHING = -1,\n")[2], re.MULTILINE)
        fields = [
            ("phase", ctypes.c_int),
            ("began", ctypes.c_double),
            ("switches", ctypes.c_int),
            ("held", ctypes.c_double * sizes["SPEAR_HELD"]),
            ("armed", ctypes.c_int * sizes["SPEAR_WATCHED"]),
            ("threshold", ctypes.c_double),
        ]
        self.own = type("spear_controller", (ctypes.Structure,), {"_fields_": fields})()
        self.system, self._library = gait.system, ctypes.CDLL(str(folder / "c.so"))
        self._u = array([0.0 for _ in gait.system.robot.actuated])

    def call(self, name, *arguments):
        return getattr(self._library, f"spear_{name}")(ctypes.byref(self.own), *arguments)

    def torques(self, t, q, v):
        self.call("torques", ctypes.c_double(t), array(q), array(v), self._u)
        return list(self._u)

    def tell(self, event, t, q, v):
        return self.call("event", self.events.index(event), ctypes.c_double(t), array(q), array(v))

    def step(self, t, q, v):
        event = self.call("step", ctypes.c_double(t), array(q), array(v), self._u)
        return event, list(self._u)

    def begin(self, t, q, v):
        self.call("init", 1, ctypes.c_double(t), array(q), array(v))

    def closed(self):
        """The system whose torques, and what its events latch for them, the controller computes."""
        domains = []
        for domain in self.system.domains:
            names = {id(each.reset): each.name for each in happenings(domain)}
            latching = partial(self._latching, self.system.phases.index(domain.phase), names)
            guards = [replace(guard, reset=latching(guard.reset)) for guard in domain.guards]
            switch = domain.switch and replace(domain.switch, reset=latching(domain.switch.reset))
            law = partial(self._law, self.system.phases.index(domain.phase))
            domains.append(replace(domain, law=law, guards=tuple(guards), switch=switch))
        return replace(self.system, domains=tuple(domains))

    def _law(self, phase, t, q, v, held, p, dyn, ops):
        self.own.phase, self.own.began, self.own.held[:] = phase, 0.0, held["c"]
        return self.torques(t, q, v)

    def _latching(self, phase, names, reset):
        if id(reset) not in names:
            return reset
        name = names[id(reset)]

        def latch(q, v, held, p):
            found = {} if reset.latch is None else dict(reset.latch(q, v, held, p))
            if "c" not in held:  # a run begins
                self.begin(0.0, q, v)
            else:
                self.own.phase, self.own.held[:] = phase, held["c"]
                assert self.tell(f"SPEAR_{name.upper()}", 0.0, q, v)
            return found | {"c": tuple(self.own.held)}

        return replace(reset, latch=latch)
