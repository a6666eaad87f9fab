"""The samples of a page: their columns and units, and that no more are kept than there is room for."""

from __future__ import annotations

import base64
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pandas
import pytest

from spear_pin import hopping, load, simulate
from spear_pin.errors import BadValue
from spear_pin.model.robot import Robot
from spear_pin.viz import player
from spear_pin.viz.bench.samples import Column, Samples, packed, plotted, samples_of, thinned
from spear_pin.viz.playback import trajectory as pieces
from spear_pin.viz.playback.scene import GHOST, joint_paths
from tests.viz import samples
from tests.viz.recording import read

NAMES = ["t", "cycle", "q_boom_z", "v_knee", "a_boom_x", "u_knee", "tau_hip", "current_knee", "force_x_toe"]


@pytest.fixture(scope="module")
def told(hop: SimpleNamespace) -> SimpleNamespace:
    """The hop with columns, as a simulated one has them: numbers of samples by place."""
    n = len(hop.t)
    table = np.arange(n)[:, None] + np.linspace(0.0, 0.5, len(NAMES))
    table[:, NAMES.index("tau_hip")] = 2.5
    return SimpleNamespace(**vars(hop), columns=lambda: (NAMES, table))


def decoded(data: dict) -> dict[str, np.ndarray]:
    """Columns of a page by their names, `t` among them."""
    t = np.frombuffer(base64.b64decode(data["times"]), "<f8")
    values = iter(np.frombuffer(base64.b64decode(data["values"]), "<f4").reshape(-1, len(t)))
    columns = {c["name"]: np.full(len(t), c["still"]) if "still" in c else next(values) for c in data["columns"]}
    return {"t": t, **columns}


def test_columns_have_their_kind_and_unit(spear: Robot, told: SimpleNamespace) -> None:
    found = {column.name: (column.label, column.kind, column.unit) for column in samples_of(spear, told).columns}
    assert found == {
        "cycle": ("cycle", "cycle", ""),
        "q_boom_z": ("boom_z", "position", "m"),
        "v_knee": ("knee", "velocity", "rad/s"),
        "a_boom_x": ("boom_x", "acceleration", "m/s²"),
        "u_knee": ("knee", "motor torque", "N·m"),
        "tau_hip": ("hip", "joint torque", "N·m"),
        "current_knee": ("knee", "current", "A"),
        "force_x_toe": ("toe", "force along the ground", "N"),
    }


def test_without_columns_there_are_configuration_and_forces(spear: Robot, hop: SimpleNamespace) -> None:
    found = samples_of(spear, hop)
    assert [column.name for column in found.columns] == [
        *(f"q_{name}" for name in spear.coordinates),
        "force_x_toe",
        "force_z_toe",
    ]
    assert found.t[0] == 0.0 and found.t[-1] == pytest.approx(np.ptp(hop.t))
    np.testing.assert_array_equal(found.columns[-1].values, hop.force[:, 0, 1])
    assert plotted(found) == ["q_boom_z", "q_hip", "q_knee", "force_z_toe"]


def test_a_page_holds_them(spear: Robot, told: SimpleNamespace) -> None:
    data = read(player.page(spear, told)).data["samples"]
    names, table = told.columns()
    page = decoded(data)
    np.testing.assert_allclose(page["t"], told.t - told.t[0], rtol=0, atol=1e-12)
    for name, values in zip(names[1:], table.T[1:], strict=True):
        np.testing.assert_allclose(page[name], values, rtol=1e-6)
    assert data["every"] == 1.0 and data["plotted"] == ["u_knee"]
    assert data["order"][:4] == ["t", "domain", "cycle", "q_boom_z"] and data["order"][-1] == "engaged_knee"


def test_a_page_names_columns_as_a_file_of_the_trajectory(tmp_path: Path) -> None:
    """Headings, and words by rows, whether all of it or a part is shown."""
    system = hopping(load("spear_ii", locked=["boom_x"]))
    hops = simulate(system, system.guess(), cycles=1)
    file = pandas.read_csv(hops.export(tmp_path / "hop.csv"), dtype=str)
    for shown in (hops, pieces.between(hops, hops.t[0], hops.t[-1])):
        data = packed(samples_of(system.robot, shown))
        titles = {"t": data["time"], **{each["name"]: each["heading"] for each in data["columns"]}}
        assert [titles.get(name, name) for name in data["order"]] == list(file)
        assert list(data["words"]) == ["domain", "phase", "engaged_knee"]
        for name, runs in data["words"].items():
            ends = [*(row for row, _ in runs[1:]), len(file)]
            words = [word for (row, word), end in zip(runs, ends, strict=True) for _ in range(end - row)]
            assert words == file[name].tolist()


def test_a_part_keeps_its_columns(spear: Robot, told: SimpleNamespace) -> None:
    part = pieces.between(told, 3.1, 3.4)
    inside = (told.t >= 3.1) & (told.t <= 3.4)
    columns = {column.name: column.values for column in samples_of(spear, part).columns}
    np.testing.assert_array_equal(columns["q_boom_z"], told.columns()[1][inside, NAMES.index("q_boom_z")])


def test_too_many_are_thinned_but_for_both_sides_of_an_event() -> None:
    t = np.repeat(np.arange(500.0), 2)[1:-1]
    t = np.sort(np.r_[np.linspace(0.0, 499.0, 20_000), t[(t % 100 == 0) & (t > 0)]])
    moving, still = np.sin(t), np.zeros_like(t)
    words = {"domain": np.where(t < 250.0, "stance", "flight")}
    both = Samples(t, (Column("a", "a", "", "", moving), Column("b", "b", "", "", still)), words=words)
    few = thinned(both, 1000)
    assert len(few.t) <= 1000 and few.t[0] == 0.0 and few.t[-1] == 499.0
    assert {100.0, 200.0, 300.0, 400.0} <= set(few.t[1:][np.diff(few.t) == 0])
    assert few.every == pytest.approx(len(t) / len(few.t))
    assert few.words["domain"].tolist() == np.where(few.t < 250.0, "stance", "flight").tolist()
    assert thinned(both, 30_000) is both, "what stays the same takes no room"
    assert len(packed(few)["values"]) <= 1000 * 4 * 4 / 3 + 4


def test_a_ghost_moves_beside_the_robot_until_its_end(spear: Robot, hop: SimpleNamespace) -> None:
    other = samples.hop(hops=1)
    found = read(player.page(spear, hop, ghost=other))
    knee = joint_paths(spear.model, GHOST)[-1]
    own = joint_paths(spear.model)[-1]
    for time in (0.05, 0.3):
        assert found.pose(knee, time) == pytest.approx(found.pose(own, time), abs=1e-3)
    assert [bool(found.value(GHOST, "visible", time)[0]) for time in (0.1, 0.5, 0.6)] == [True, True, False]
    assert found.data["ghost"]["path"] == GHOST
    assert not any(path.startswith(GHOST) for path in found.paths), "its shapes are the robot's, and stand there once"


def test_a_ghost_that_cannot_be_played_is_refused_by_its_name(spear: Robot, hop: SimpleNamespace) -> None:
    with pytest.raises(BadValue, match="ghost.q"):
        player.page(spear, hop, ghost=SimpleNamespace(**{**vars(hop), "q": np.zeros((3, 4))}))
    with pytest.raises(BadValue, match="ghost.t"):
        player.page(spear, hop, ghost=SimpleNamespace(**{**vars(hop), "t": [0.0]}))
