"""Trajectories made by kinematics alone, a hop, a bound and a turn, and words that a page has to escape."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np

LINK = 0.318
GRAVITY = 9.81
ODD = """</script><b>x</b> "a" & 'b' {{ c }} {% d %}"""


def hop(hops: int = 2, samples: int = 160, start: float = 0.0) -> SimpleNamespace:
    """SPEAR-II hopping in place: toe at the origin in stance, ballistic in flight."""
    stance, rate, deep = 0.22, 1.6, 0.50
    flight = 2 * rate / GRAVITY
    touch = deep + 0.06
    t, height, leg, force, domain, events = [], [], [], [], [], []
    now = start
    for _ in range(hops):
        s = np.linspace(0.0, 1.0, samples) ** 1.3
        t.append(now + stance * s)
        # leaves as fast as it lands
        depth = rate * stance / np.pi * np.sin(np.pi * s)
        height.append(touch - depth)
        leg.append(touch - depth)
        force.append(np.column_stack((18 * np.sin(2 * np.pi * s), 420 * np.sin(np.pi * s))))
        domain += ["stance"] * samples
        now += stance
        events.append(SimpleNamespace(name="liftoff", time=now))
        s = np.linspace(0.0, 1.0, samples)
        t.append(now + flight * s)
        height.append(touch + rate * flight * s - GRAVITY / 2 * (flight * s) ** 2)
        leg.append(touch - 0.14 * np.sin(np.pi * s) ** 2)
        force.append(np.zeros((samples, 2)))
        domain += ["flight"] * samples
        now += flight
        events.append(SimpleNamespace(name="touchdown", time=now))
    knee = 2 * np.arccos(np.concatenate(leg) / (2 * LINK))
    q = np.column_stack((np.zeros(len(knee)), np.concatenate(height), knee / 2, knee))
    names = np.array(domain)
    return SimpleNamespace(
        t=np.concatenate(t),
        q=q,
        domain=names,
        force=np.concatenate(force)[:, None, :],
        events=events,
        spring_joints=("knee",),
        engaged=(names == "stance")[:, None],
    )


def bound(strides: int = 4, speed: float = 2.5) -> SimpleNamespace:
    """Q-SPEAR running forward, its legs on the ground one pair after the other."""
    period, samples = 0.40, 60
    phases = (
        ("posterior stance", 0.0, 0.3),
        ("flight", 0.3, 0.5),
        ("anterior stance", 0.5, 0.8),
        ("gathered", 0.8, 1.0),
    )
    rows, t, domain, events = [], [], [], []
    force, engaged = [], []
    for stride in range(strides):
        for name, begin, end in phases:
            phase = np.linspace(begin, end, samples)
            t.append((stride + phase) * period)
            rear_swing = 0.45 * np.cos(2 * np.pi * (phase + 0.0))
            fore_swing = 0.45 * np.cos(2 * np.pi * (phase - 0.5))
            bend = 1.0 + 0.25 * np.sin(2 * np.pi * phase)
            x = speed * (stride + phase) * period
            rows.append(
                np.column_stack(
                    (
                        x,
                        0.60 + 0.03 * np.cos(4 * np.pi * (phase - 0.4)),
                        0.10 * np.sin(2 * np.pi * phase),
                        bend / 2 + rear_swing,
                        bend,
                        -bend / 2 + fore_swing,
                        -bend,
                    )
                )
            )
            push = np.sin(np.pi * (phase - begin) / (end - begin))
            pair = np.zeros((samples, 2, 2))
            leg = {"posterior stance": 0, "anterior stance": 1}.get(name)
            if leg is not None:
                pair[:, leg] = np.column_stack((60 * np.cos(np.pi * (phase - begin) / (end - begin)), 1100 * push))
            force.append(pair)
            engaged.append(np.tile([leg == 0, leg == 1], (samples, 1)))
            domain += [name] * samples
            events.append(SimpleNamespace(name=f"end of {name}", time=float(t[-1][-1])))
    return SimpleNamespace(
        t=np.concatenate(t),
        q=np.concatenate(rows),
        domain=np.array(domain),
        force=np.concatenate(force),
        events=events,
        spring_joints=("posterior_knee", "anterior_knee"),
        engaged=np.concatenate(engaged),
    )


def turn(strides: int = 8, radius: float = 4.0, speed: float = 2.5, bank: float = 0.1) -> SimpleNamespace:
    """Q-SPEAR on a chain along a circle to the left, leaning inward, its pairs of legs on the ground by turns."""
    planar = bound(strides, speed)
    way, n = planar.q[:, 0], len(planar.t)
    q = np.zeros((n, 18))
    q[:, 0], q[:, 1] = radius * np.sin(way / radius), radius * (1.0 - np.cos(way / radius))
    q[:, 2], q[:, 3], q[:, 4], q[:, 5] = planar.q[:, 1], way / radius, planar.q[:, 2], -bank
    for leg in range(4):
        q[:, 7 + 3 * leg : 9 + 3 * leg] = planar.q[:, 3 + 2 * (leg // 2) : 5 + 2 * (leg // 2)]
    along, normal = (0.5 * np.repeat(planar.force[:, :, axis], 2, axis=1) for axis in (0, 1))
    inward = 0.1 * normal
    yaw = q[:, 3, None]
    force = np.stack(
        (along * np.cos(yaw) - inward * np.sin(yaw), along * np.sin(yaw) + inward * np.cos(yaw), normal), axis=2
    )
    knees = tuple(f"{pair}_{side}_knee" for pair in ("posterior", "anterior") for side in ("left", "right"))
    engaged = np.repeat(planar.engaged, 2, axis=1)
    return SimpleNamespace(**{**vars(planar), "q": q, "force": force, "spring_joints": knees, "engaged": engaged})
