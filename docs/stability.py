"""The picture of what makes the trot stable: gaits found again over numbers of the robot, with the same feedback."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from matplotlib.figure import Figure

from spear_pin import Gait, find_gait
from spear_pin.errors import NoGait
from spear_pin.gaits.feedback import add_feedback
from spear_pin.hybrid.event_feedback import EventFeedback, feedback_of, with_feedback
from spear_pin.hybrid.parameters import number, with_numbers
from spear_pin.hybrid.periodic import chart, multipliers
from spear_pin.viz.plots.paper import Picture, style

NUMBERS = (  # name, label, ends of the range, step
    ("roll_inertia_xx", "roll inertia of the torso (kg·m²)", (0.2, 1.2), 0.025),
    ("hip_spacing", "distance between left and right hips (m)", (0.2, 0.45), 0.005),
)


def stability() -> Figure:
    """Plots the trot's multipliers over roll inertia and hip spacing, without feedback and with that of the trot."""
    trot = Gait.load("trot")
    steady = add_feedback(trot)
    print("multipliers with feedback", np.sort(np.abs(steady.multipliers))[:-4:-1])
    with style():
        figure = Picture(figsize=(7.0, 3.2), layout="constrained")
        axes = figure.subplots(1, 2, sharey=True)
        for ax, (name, label, ends, step) in zip(axes, NUMBERS, strict=True):
            gaits = [gait for end in ends for gait in walked(trot, name, end, step)]
            gaits.sort(key=lambda gait: number(gait.system, name))
            x = [number(gait.system, name) for gait in gaits]
            free = np.array([np.sort(np.abs(gait.multipliers))[::-1] for gait in gaits])
            held = [largest_held(gait, feedback_of(steady.system)) for gait in gaits]
            for i, text in enumerate(("largest", "second", "third")):
                ax.plot(x, free[:, i], label=f"{text}, without feedback")
            ax.plot(x, held, "k--", label="largest, with the trot's own feedback")
            ax.axhline(1.0, color="0.6", lw=0.8)
            ax.axvline(number(trot.system, name), color="0.6", lw=0.8, ls=":")
            ax.set_xlabel(label)
            print(name, f"{x[0]:.4f} to {x[-1]:.4f}:", free[0, :3], free[-1, :3], f"held at most {max(held):.3f}")
        axes[0].set_ylabel("|multiplier| of half a stride")
        figure.legend(*axes[0].get_legend_handles_labels(), loc="outside upper center", ncols=2)
    return figure


def walked(gait: Gait, name: str, end: float, step: float) -> list[Gait]:
    """Returns gaits from one to another value of a number, or to where the branch ends, with steps down to 1/64."""
    found, least = [gait], step / 64.0
    while step >= least and (last := number(found[-1].system, name)) != end:
        value = end if abs(end - last) <= step else last + math.copysign(step, end - last)
        before = found[-2:]
        (q, v), reach = before[-1].state, 0.0
        if len(before) > 1:
            past = number(before[0].system, name)
            reach = (value - last) / (last - past)
        guess = tuple(now + reach * (now - then) for now, then in zip((q, v), before[0].state, strict=True))
        try:
            found.append(find_gait(with_numbers(gait.system, {name: value}), guess=guess))
        except NoGait:
            step /= 2.0
    return found


def largest_held(gait: Gait, feedback: EventFeedback) -> float:
    """Returns the largest multiplier of a gait with the gains of another one's feedback."""
    section = chart(gait.system, gait.state)
    nominal = np.concatenate(section.state(np.zeros(section.dimension)))
    closed = with_feedback(gait.system, replace(feedback, nominal=tuple(nominal)))
    return float(np.abs(multipliers(closed, gait.state)).max())
