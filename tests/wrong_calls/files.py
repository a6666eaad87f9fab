"""Files that are damaged, or something else; read by a command and from Python."""

from __future__ import annotations

import io
import json
import pickle
import zipfile
from collections.abc import Callable, Iterator, Mapping
from functools import cache
from pathlib import Path

import numpy as np

from tests.wrong_calls.case import Command, Function

Damage = Callable[[bytes], bytes]


@cache
def _trajectory() -> bytes:
    from spear_pin import hopping, load, simulate
    from spear_pin.hybrid.trajectory import Trajectory

    system = hopping(load("spear_ii", locked=["boom_x"]))
    made: Trajectory = simulate(system, system.guess(), 1, 1e-6)
    import tempfile

    with tempfile.TemporaryDirectory() as folder:
        return made.save(Path(folder) / "a.npz").read_bytes()


@cache
def _record() -> bytes:
    import tempfile

    from spear_pin.studies.laboratory import synthesize, write_csv
    from spear_pin.studies.push_test import WITH_MOTOR, spear_ii

    with tempfile.TemporaryDirectory() as folder:
        made = synthesize(spear_ii(), WITH_MOTOR, repeats=1, rate=100)
        return write_csv(made, Path(folder) / "a.csv").read_bytes()


@cache
def _gait() -> bytes:
    from spear_pin.gaits import library

    return library.path("long_stride").read_bytes()


@cache
def _urdf() -> bytes:
    from spear_pin.model.loading import ROBOTS

    return ROBOTS["spear_ii"].path.read_bytes()


@cache
def _mjcf() -> bytes:
    from spear_pin import load
    from spear_pin.model.mjcf import to_mjcf

    return to_mjcf(load("spear_ii")).encode()


@cache
def _hops() -> bytes:
    """A log of a crank that folds and stretches, without a model behind it."""
    t = np.arange(0.0, 0.9, 0.002)
    crank = -20.0 + np.where(t % 0.4 < 0.2, 28.0 * np.sin(np.pi * (t % 0.4) / 0.2), 0.0)
    rows = "\n".join(f"{time:.3f},{angle:.4f},0" for time, angle in zip(t, crank, strict=True))
    return f"time_s,crank_deg,crank_torque_Nm\n{rows}\n".encode()


def trajectory(path: Path) -> Path:
    """A trajectory that can be read."""
    path.write_bytes(_trajectory())
    return path


def record(path: Path) -> Path:
    """A record that can be read."""
    path.write_bytes(_record())
    return path


def hops(path: Path) -> Path:
    """A log that can be read."""
    path.write_bytes(_hops())
    return path


ANY: Mapping[str, Damage] = {
    "empty": lambda content: b"",
    "one byte": lambda content: b"x",
    "zeros": lambda content: bytes(1000),
    "noise": lambda content: np.random.default_rng(0).bytes(5000),
    "its first half": lambda content: content[: len(content) // 2],
    "utf-16": lambda content: content.decode("latin-1").encode("utf-16"),
    "a picture": lambda content: b"\x89PNG\r\n\x1a\n" + bytes(100),
    "a pickle": lambda content: pickle.dumps({"format": 1}),
    "JSON of a number": lambda content: b"5",
    "JSON of a list": lambda content: b"[]",
    "JSON of nothing": lambda content: b"{}",
    "JSON nested deep": lambda content: 100_000 * b"[",
    "HTML": lambda content: b"<!doctype html><title>404</title>",
}


def _json(*path: object, value: object) -> Damage:
    def damage(content: bytes) -> bytes:
        data = json.loads(content)
        at = data
        for key in path[:-1]:
            at = at[key]
        at[path[-1]] = value
        return json.dumps(data).encode()

    return damage


def _without(key: str) -> Damage:
    return lambda content: json.dumps({k: v for k, v in json.loads(content).items() if k != key}).encode()


GAIT: Mapping[str, Damage] = {
    **{f"without {key}": _without(key) for key in ("format", "kind", "robot", "law", "spring", "state", "multipliers")},
    **{
        f"{'.'.join(map(str, path))} is {value!r:.20}": _json(*path, value=value)
        for path, value in (
            (("format",), "other"),
            (("kind",), "flying"),
            (("robot",), None),
            (("robot", "source"), "nope"),
            (("robot", "toes"), 5),
            (("robot", "locked"), ["ankle"]),
            (("law",), []),
            (("law", "posterior_hip_torque"), "much"),
            (("law", "posterior_stance_swing"), [1]),
            (("spring", "stiffness"), -1),
            (("spring", "unilateral"), "no"),
            (("contact", "friction"), 0),
            (("state", "q"), [1, 2]),
            (("state", "q"), "q"),
            (("state", "v"), 7 * [float("nan")]),
            (("residual",), "small"),
            (("residual",), float("nan")),
            (("multipliers",), [[1]]),
            (("multipliers",), [[float("nan"), 0]]),
            (("durations",), 5),
            (("durations",), {"posterior_stance": "long"}),
            (("parameters",), []),
        )
    },
}


def _npz(**changes: object) -> Damage:
    """The archive with other arrays; None leaves one out."""

    def damage(content: bytes) -> bytes:
        with np.load(io.BytesIO(content)) as archive:
            data = {**{name: archive[name] for name in archive.files}, **changes}
        file = io.BytesIO()
        np.savez(file, **{name: np.asarray(value) for name, value in data.items() if value is not None})
        return file.getvalue()

    return damage


def _pickled(content: bytes) -> bytes:
    file = io.BytesIO()
    np.savez(file, **{"t": np.array([print], dtype=object)})
    return file.getvalue()


def _zip(content: bytes) -> bytes:
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w") as archive:
        archive.writestr("t.npy", b"no array")
    return file.getvalue()


NPZ: Mapping[str, Damage] = {
    "with an object in it": _pickled,
    "an archive of no array": _zip,
    **{f"without {name}": _npz(**{name: None}) for name in ("t", "q", "v", "force", "phase", "cycle")},
    **{f"{name} of one number": _npz(**{name: 1.0}) for name in ("t", "q", "v", "force", "tau")},
    **{f"{name} of no number": _npz(**{name: np.array([])}) for name in ("t", "q", "v", "cycle")},
    "times that go back": _npz(t=np.array([1.0, 0.5])),
    "a time that is none": _npz(t=np.array([np.nan])),
    "texts as angles": _npz(q=np.array(["a", "b"])),
}


def _replaced(old: str, new: str) -> Damage:
    return lambda content: content.decode().replace(old, new, 1).encode()


URDF: Mapping[str, Damage] = {
    "no robot": _replaced("<robot", "<robert"),
    "a bomb of entities": lambda content: (
        b'<!DOCTYPE r [<!ENTITY a "aaaaaaaaaa"><!ENTITY b "&a;&a;&a;&a;">]><robot name="&b;"/>'
    ),
    "a file of the disk": lambda content: b'<!DOCTYPE r [<!ENTITY a SYSTEM "/etc/passwd">]><robot name="r">&a;</robot>',
    "a mass that is none": _replaced('mass value="', 'mass value="x'),
    "a negative mass": _replaced('mass value="', 'mass value="-'),
    "a mass of nan": _replaced('<mass value="', '<mass value="nan" other="'),
    "a huge mass": _replaced('<mass value="', '<mass value="1e300" other="'),
    "an unknown type of joint": _replaced('type="prismatic"', 'type="spiral"'),
    "an unknown parent": _replaced('parent link="', 'parent link="no_'),
    "an unknown child": _replaced('child link="', 'child link="no_'),
    "an axis of zeros": _replaced('axis xyz="', 'axis xyz="0 0 0" other="'),
    "a name twice": _replaced('<joint name="boom_z"', '<joint name="boom_x"'),
    "no end": lambda content: content.replace(b"</robot>", b""),
    "no links": lambda content: b'<robot name="r"/>',
}

MJCF: Mapping[str, Damage] = {
    "no bodies": lambda content: b"<mujoco><worldbody/></mujoco>",
    "a bomb of entities": lambda content: b'<!DOCTYPE m [<!ENTITY a "aaaa"><!ENTITY b "&a;&a;">]><mujoco model="&b;"/>',
    "a file of the disk": lambda content: b'<mujoco><include file="/etc/passwd"/></mujoco>',
    "an included folder": lambda content: b'<mujoco><include file="."/></mujoco>',
    "a file that includes itself": lambda content: b'<mujoco><include file="a.xml"/></mujoco>',
    "a negative mass": _replaced(' mass="', ' mass="-'),
    "a mass that is none": _replaced(' mass="', ' mass="x'),
    "an inertia of one number": _replaced(' fullinertia="', ' fullinertia="1" other="'),
    "a place of two numbers": _replaced("<body ", '<body pos="1 2" '),
    "an axis of zeros": _replaced('axis="', 'axis="0 0 0" other="'),
    "an axis of one number": _replaced('axis="', 'axis="1" other="'),
    "a name twice": _replaced('<joint name="boom_z"', '<joint name="boom_x"'),
    "a body twice": lambda content: content.replace(b'<body name="thigh"', b'<body name="shank"'),
    "an unknown type of joint": _replaced('type="slide"', 'type="spiral"'),
    "a range of one number": _replaced('range="', 'range="1" other="'),
    "a gear of nothing": _replaced('gear="', 'gear="" other="'),
    "no end": lambda content: content.replace(b"</mujoco>", b""),
}

CSV: Mapping[str, Damage] = {
    "a head only": lambda content: b"time,voltage\n",
    "one row": lambda content: b"time,voltage\n0,1\n",
    "one column": lambda content: b"time\n0\n1\n2\n",
    "texts": lambda content: b"time,voltage\n" + 50 * b"a,b\n",
    "nan": lambda content: b"time,voltage\n" + 50 * b"nan,nan\n",
    "a time that stands still": lambda content: b"time,voltage\n" + 500 * b"0,1\n",
    "a time that goes back": lambda content: b"time,voltage\n" + b"".join(b"%d,1\n" % -i for i in range(500)),
    "nothing happens": lambda content: b"time,voltage\n" + b"".join(b"%g,1\n" % (0.01 * i) for i in range(900)),
    "rows of different lengths": lambda content: b"time,voltage\n0,1\n1\n2,3,4\n" * 30,
    "huge numbers": lambda content: b"time,voltage\n" + b"".join(b"%g,1e308\n" % (0.01 * i) for i in range(900)),
    "a quotation without an end": lambda content: b'time,"voltage\n' + 50 * b"0,1\n",
}

LOG: Mapping[str, Damage] = {
    "a head only": lambda content: b"time_s,crank_deg\n",
    "one row": lambda content: b"time_s,crank_deg\n0,1\n",
    "texts": lambda content: b"time_s,crank_deg\n" + 50 * b"a,b\n",
    "nan": lambda content: b"time_s,crank_deg\n" + 50 * b"nan,nan\n",
    "a time that stands still": lambda content: b"time_s,crank_deg\n" + 500 * b"0,1\n",
    "a time that goes back": lambda content: b"time_s,crank_deg\n" + b"".join(b"%d,1\n" % -i for i in range(500)),
    "a time of another clock": lambda content: content + b"1717444672,0,0\n",
    "nothing happens": lambda content: b"time_s,crank_deg\n" + b"".join(b"%g,1\n" % (0.01 * i) for i in range(900)),
    "huge numbers": lambda content: b"time_s,crank_deg\n" + b"".join(b"%g,1e308\n" % (0.01 * i) for i in range(900)),
}

# what is read, how it ends, its own damages, the command that reads it, and the function
FORMATS: tuple[tuple[str, str, Callable[[], bytes], Mapping[str, Damage], str, str], ...] = (
    ("gait", "a.json", _gait, GAIT, "bound --gait ./a.json", "spear_pin.Gait.load"),
    ("trajectory", "a.npz", _trajectory, NPZ, "export a.npz --csv", "spear_pin.Trajectory.load"),
    ("URDF", "a.urdf", _urdf, URDF, "dynamics a.urdf", "spear_pin.load"),
    ("MJCF", "a.xml", _mjcf, MJCF, "dynamics a.xml", "spear_pin.load"),
    ("record", "a.csv", _record, CSV, "identify a.csv --volts-per-rad 1", "studies.identification.read_record"),
    ("record", "a.mat", _record, {}, "identify a.mat --volts-per-rad 1", "studies.identification.read_record"),
    ("log", "hops.csv", _hops, LOG, "fit crank_hopper hops.csv --over stiffness", "studies.logs.Log.read"),
)
FINE = {  # a record all the same, and a log
    *(("record", what) for what in ("nothing happens", "huge numbers", "its first half")),
    *(("log", what) for what in ("nothing happens", "its first half")),
}
FITTING = {("URDF", "utf-16"), ("MJCF", "utf-16")}  # XML says how it is encoded


def cases() -> Iterator[Command | Function]:
    """Every damaged file, read twice."""
    for kind, name, whole, own, line, reader in FORMATS:
        for what, damage in {**ANY, **own}.items():
            if (kind, what) in FITTING:
                continue
            prepare = _prepare(name, whole, damage)
            if (kind, what) != ("log", "its first half"):  # it has a hop
                yield _Named((*line.split(),), prepare, f"{kind} {name}: {what}")
            if (kind, what) not in FINE:
                yield Function(f"{reader} of {name}: {what}", lambda folder, r=reader, n=name: _read(r, n), prepare)
        yield _Named((*line.split(),), lambda folder, n=name: (folder / n).mkdir(), f"{kind} {name}: a folder")
        yield _Named((*line.split(),), lambda folder, n=name: _fifo(folder / n), f"{kind} {name}: a pipe")
        yield _Named(
            (*line.split(),), lambda folder, n=name: (folder / n).symlink_to(folder / n), f"{kind} {name}: its own link"
        )


class _Named(Command):
    """A command that is called by what is wrong with its file."""

    def __init__(self, words: tuple[str, ...], prepare: Callable[[Path], object], what: str) -> None:
        super().__init__(words, prepare)
        object.__setattr__(self, "what", what)

    @property
    def name(self) -> str:
        return f"{super().name}: {self.what}"


def _prepare(name: str, whole: Callable[[], bytes], damage: Damage) -> Callable[[Path], object]:
    return lambda folder: (folder / name).write_bytes(damage(whole()))


def _fifo(path: Path) -> None:
    import os

    os.mkfifo(path)


def _read(reader: str, name: str) -> object:
    import spear_pin
    from spear_pin.studies.identification import Calibration, read_record

    if reader.startswith("spear_pin."):
        function = spear_pin
        for part in reader.split(".")[1:]:
            function = getattr(function, part)
        return function(f"./{name}")
    return read_record(f"./{name}", calibration=Calibration(1.0, 0.0))
