"""Trajectories, gaits and logs: archives that grow, arrays that lie, numbers without end, and texts that act."""

from __future__ import annotations

import io
import json
import struct
import zipfile
import zlib
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from tests.hostile.case import Hostile, put, sparse
from tests.hostile.robots import WHOLE
from tests.wrong_calls.files import Damage

HARM = {
    "escapes": "\x1b]0;title\x07\x1b[2J",
    "C1": "\x9b31m\x85",
    "marks of direction": "\u202etxt.exe\u2066\u200f",
    "no width": "\u200bknee\ufeff",
    "ends of lines": "a\nspear: all is well\r\u2028",
    "lone surrogates": "\ud800a\udfff",
}


def npz(change: Callable[[dict[str, Any], dict[str, Any]], Any]) -> Damage:
    """A trajectory whose meta and arrays are changed in place."""

    def damage(content: bytes) -> bytes:
        with np.load(io.BytesIO(content)) as archive:
            arrays = {name: archive[name] for name in archive.files}
        meta = json.loads(str(arrays.pop("meta")))
        meta.pop("origin", None)
        change(meta, arrays)
        file = io.BytesIO()
        np.savez(file, meta=np.array(meta if isinstance(meta, str) else json.dumps(meta)), **arrays)
        return file.getvalue()

    return damage


def _member(name: str, content: Callable[[], bytes], kind: int = zipfile.ZIP_DEFLATED) -> Damage:
    """A trajectory with another member of the archive."""

    def damage(whole: bytes) -> bytes:
        file = io.BytesIO()
        with zipfile.ZipFile(io.BytesIO(whole)) as old, zipfile.ZipFile(file, "w", kind) as new:
            for info in old.infolist():
                if info.filename != name:
                    new.writestr(info.filename, old.read(info))
            new.writestr(name, content())
        return file.getvalue()

    return damage


def _npy(head: str, rest: bytes = b"") -> bytes:
    return b"\x93NUMPY\x01\x00" + struct.pack("<H", min(len(head), 65_535)) + head.encode()[:65_535] + rest


def _text_meta(text: Callable[[], str]) -> Damage:
    return _member("meta.npy", lambda: _saved(np.array(text())))


def _saved(array: np.ndarray) -> bytes:
    file = io.BytesIO()
    np.save(file, array)
    return file.getvalue()


def _many(content: bytes) -> bytes:
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w") as archive:
        for i in range(20_000):
            archive.writestr(f"{i}.npy", b"")
    return file.getvalue()


def _flagged(content: bytes) -> bytes:
    """With the flag of encryption in each header."""
    return content.replace(b"PK\x03\x04\x14\x00\x00\x00", b"PK\x03\x04\x14\x00\x01\x00").replace(
        b"PK\x01\x02\x14\x03\x14\x00\x00\x00", b"PK\x01\x02\x14\x03\x14\x00\x01\x00"
    )


def _huge_numbers(name: str, value: float) -> Damage:
    return npz(lambda meta, arrays: arrays[name].__setitem__(..., value))


def _of_events(meta: dict[str, Any], arrays: dict[str, Any]) -> None:
    meta["events"] = meta["events"][:1] * 100_000


ZEROS = (
    b"\x93NUMPY\x01\x00v\x00" + b"{'descr': '<f8', 'fortran_order': False, 'shape': (300000000,), }".ljust(117) + b"\n"
)
NPZ: Mapping[str, Damage] = {
    "a bomb of zeros": _member("t.npy", lambda: ZEROS + bytes(200_000_000)),
    "a bomb beside": _member("more.npy", lambda: bytes(300_000_000)),
    "a shape of 10^15": _member(
        "t.npy", lambda: _npy("{'descr': '<f8', 'fortran_order': False, 'shape': (1000000000000000,), }\n")
    ),
    "a shape below zero": _member(
        "t.npy", lambda: _npy("{'descr': '<f8', 'fortran_order': False, 'shape': (-5,), }\n")
    ),
    "a shape of 60,000 axes": _member(
        "t.npy", lambda: _npy("{'descr': '<f8', 'fortran_order': False, 'shape': (" + "1," * 30_000 + "), }\n")
    ),
    "a text of 10^9 letters": _member(
        "phase.npy", lambda: _npy("{'descr': '<U1000000000', 'fortran_order': False, 'shape': (1,), }\n")
    ),
    "a type of nothing": _member("t.npy", lambda: _npy("{'descr': '<V0', 'fortran_order': False, 'shape': (9,), }\n")),
    "a type of many": _member(
        "t.npy", lambda: _npy("{'descr': [" + "('a', '<f8'), " * 4000 + "], 'fortran_order': False, 'shape': (9,), }\n")
    ),
    "a header that is a call": _member("t.npy", lambda: _npy("__import__('os').system('touch hacked')\n")),
    "a header of brackets": _member("t.npy", lambda: _npy("(" * 60_000)),
    "a header of powers": _member(
        "t.npy", lambda: _npy("{'descr': '<f8', 'fortran_order': False, 'shape': (9**9**9,), }\n")
    ),
    "a header of minus signs": _member("t.npy", lambda: _npy("-" * 60_000 + "1")),
    "a pickle": _member("t.npy", lambda: _saved(np.array([{}], dtype=object))),
    "20,000 members": _many,
    "members that are encrypted": _flagged,
    "another compression": _member("t.npy", lambda: b"x" * 1000, zipfile.ZIP_LZMA),
    "a way upwards": _member("../../t.npy", lambda: b"x"),
    "a name with escapes": _member("\x1b]0;title\x07.npy", lambda: b"x"),
    "a comment of 64 kB": lambda content: content[:-2] + struct.pack("<H", 65_535) + b"\x1b[2J" * 16_000,
    "numbers the other way round": _member("t.npy", lambda: _saved(np.array([1.0, 2.0], dtype=">f8"))),
    "a meta of brackets": _text_meta(lambda: "[" * 1_000_000),
    "a meta of digits": _text_meta(lambda: '{"cycles": ' + "9" * 1_000_000 + "}"),
    "a meta of a key many times": _text_meta(lambda: "{" + '"a": 1, ' * 20_000 + '"b": 1}'),
    "a meta of zeros": _text_meta(lambda: "\0" * 1000),
    "more cycles than there are": npz(lambda meta, arrays: meta.update(cycles=10**18)),
    "100,000 events": npz(_of_events),
    "100,000 toes": npz(lambda meta, arrays: meta.update(toes=[f"toe{i}" for i in range(100_000)])),
    "a robot that is a device": npz(lambda meta, arrays: meta.update(robot="/dev/zero")),
    "a robot of the disk": npz(lambda meta, arrays: meta.update(robot="/etc/passwd")),
    "a robot whose name is 1 MB": npz(lambda meta, arrays: meta.update(robot="x" * 1_000_000)),
    "forces of 1e308": _huge_numbers("force", 1e308),
    "places of 1e308": _huge_numbers("q", 1e308),
    "torques of -1e308": _huge_numbers("tau", -1e308),
    "work of 1e308": _huge_numbers("ledger_work", 1e308),
    "times up to 1e308": npz(lambda meta, arrays: arrays["t"].__setitem__(-1, 1e308)),
    **{f"a robot with {what}": npz(lambda meta, arrays, t=text: meta.update(robot=t)) for what, text in HARM.items()},
    **{
        f"a coordinate with {what}": npz(lambda meta, arrays, t=text: meta["coordinates"].__setitem__(0, t))
        for what, text in HARM.items()
    },
    **{
        f"a phase with {what}": npz(lambda meta, arrays, t=text: arrays.update(phase=np.full(arrays["phase"].shape, t)))
        for what, text in HARM.items()
        if what != "lone surrogates"
    },
}
DRAWN = ("forces of 1e308", "places of 1e308", "times up to 1e308")  # that are asked for a picture, too


def _gait(change: Callable[[dict[str, Any]], Any]) -> Damage:
    def damage(content: bytes) -> bytes:
        data = json.loads(content)
        change(data)
        return json.dumps(data).encode()

    return damage


ANSWERS: Mapping[str, Callable[[], bytes]] = {
    "brackets": lambda: b"[" * 1_000_000,
    "an exponent of a million digits": lambda: b'{"leg_hops": [{"event": "slip", "time_s": 1e' + b"9" * 1_000_000,
    "a name that acts on a terminal": lambda: b'{"\\u001b]0;x\\u0007": []}',
    "an event that acts on a terminal": lambda: b'{"leg_hops": [{"event": "\\u001b]0;x\\u0007"}]}',
    "a million events": lambda: b'{"leg_hops": [' + b",".join([b'{"event": "slip"}'] * 1_000_000) + b"]}",
    "a million numbers": lambda: b'{"a": [{"event": "slip", "position": [' + b",".join([b"0"] * 1_000_000) + b"]}]}",
}
GAIT: Mapping[str, Damage] = {
    "brackets": lambda content: b"[" * 1_000_000,
    "objects 100,000 deep": lambda content: b'{"a":' * 100_000,
    "a number of a million digits": lambda content: content.replace(
        b'"residual": ', b'"residual": ' + b"9" * 1_000_000, 1
    ),
    "an exponent of a million digits": lambda content: content.replace(
        b'"residual": ', b'"residual": 1e' + b"9" * 1_000_000 + b', "x": ', 1
    ),
    "a key 100,000 times": lambda content: b"{" + b'"format": 1, ' * 100_000 + b'"a": 1}',
    "100,000 keys": lambda content: json.dumps({f"a{i}": 1 for i in range(100_000)}).encode(),
    "a list of a million numbers": _gait(lambda data: data["state"].update(q=[0.0] * 1_000_000)),
    "coefficients without end": _gait(lambda data: data["law"].update(posterior_stance_swing=[[0.1] * 100_000] * 2)),
    "coefficients in lists 900 deep": _gait(lambda data: data["law"].update(posterior_stance_swing=_deep(900))),
    "a state of 1e308": _gait(lambda data: data["state"].update(v=[1e308] * 7)),
    "a stiffness of 1e308": _gait(lambda data: data["spring"].update(stiffness=1e308)),
    "a period of 1e308": _gait(lambda data: data.update(period=1e308)),
    "durations of 1e308": _gait(lambda data: data.update(durations=dict.fromkeys(data["durations"], 1e308))),
    "a robot that is a device": _gait(lambda data: data["robot"].update(source="/dev/zero")),
    "a robot of the disk": _gait(lambda data: data["robot"].update(source="/etc/passwd")),
    "a robot of the network": _gait(lambda data: data["robot"].update(source="http://127.0.0.1:9/a.urdf")),
    "a robot with a zero": _gait(lambda data: data["robot"].update(source="a\0.urdf")),
    "100,000 joints that are locked": _gait(
        lambda data: data["robot"].update(locked=[f"j{i}" for i in range(100_000)])
    ),
    "numbers that are varied without end": _gait(
        lambda data: data["robot"].update(varied={f"j{i}": 1.0 for i in range(100_000)})
    ),
    "UTF-16": lambda content: content.decode().encode("utf-16"),
    "UTF-8 that is none": lambda content: content.replace(b"q_spear", b"\xff\xfe"),
    "NaN": lambda content: content.replace(b'"residual": ', b'"residual": NaN, "x": ', 1),
    "a list": lambda content: b"[" + b"0," * 500_000 + b"0]",
    **{
        f"a robot with {what}": _gait(lambda data, t=text: data["robot"].update(source=f"{t}.urdf"))
        for what, text in HARM.items()
    },
    **{f"a kind with {what}": _gait(lambda data, t=text: data.update(kind=t)) for what, text in HARM.items()},
    **{f"a law with {what}": _gait(lambda data, t=text: data["law"].update({t: 1.0})) for what, text in HARM.items()},
}


def _deep(count: int) -> list[Any]:
    found: list[Any] = [0.0]
    for _ in range(count):
        found = [found]
    return found


ROWS = b"".join(
    b"%.3f,%.5f\n" % (i / 250, 1.7 if i < 150 else 1.0 + 0.7 * np.exp(-i / 50 + 3) * np.cos(i / 12 - 12.5))
    for i in range(500)
)


def _log(head: str) -> Damage:
    return lambda content: f"{head}\n".encode("utf-8", "surrogatepass") + ROWS


CSV: Mapping[str, Damage] = {
    "a line of 60 MB": lambda content: b"1," * 30_000_000,
    "100,000 columns": lambda content: b",".join(b"c%d" % i for i in range(100_000)) + b"\n" + b"1," * 99_999 + b"1\n",
    "50,000 titles": lambda content: b"a title\n" * 50_000 + ROWS,
    "20 MB of quotes": lambda content: b'time_s,knee_rad\n"' + b'"' * 20_000_000,
    "20 MB of comments": lambda content: b"#\n" * 10_000_000 + ROWS,
    "20 MB of ends of lines": lambda content: b"time_s,knee_rad\n" + b"\n" * 20_000_000 + ROWS,
    "zeros": lambda content: bytes(10_000_000),
    "times up to 1e308": lambda content: b"time_s,knee_rad\n" + ROWS + b"1e308,1\n",
    "angles of 1e308": lambda content: b"time_s,knee_rad\n" + ROWS.replace(b"1.7000", b"1e308"),
    "numbers of a million digits": lambda content: b"time_s,knee_rad\n0," + b"9" * 1_000_000 + b"\n" + ROWS,
    "formulas": lambda content: b"time_s,knee_rad\n" + b"=cmd|' /C calc'!A0,1\n" * 600,
    **{f"a title with {what}": _log(f"{text}\ntime_s,knee_rad") for what, text in HARM.items()},
    **{f"a column with {what}": _log(f"time_s,knee {text.strip()}") for what, text in HARM.items()},
    **{f"a unit with {what}": _log(f"time_s,knee [{text.strip()}]") for what, text in HARM.items()},
}


def _mat(count: int, said: int | None = None) -> bytes:
    """A .mat file of one compressed variable of zeros, and how many it says that it has."""
    said = count if said is None else said
    name = b"knee_rad"
    parts = struct.pack("<IIII", 6, 8, 6, 0) + struct.pack("<IIii", 5, 8, said, 1) + struct.pack("<II", 1, 8) + name
    matrix = parts + struct.pack("<II", 9, (8 * count) & 0xFFFFFFFF) + bytes(8 * count)
    packed = zlib.compress(struct.pack("<II", 14, len(matrix) & 0xFFFFFFFF) + matrix)
    head = b"MATLAB 5.0 MAT-file".ljust(124) + struct.pack("<H", 0x0100) + b"IM"
    return head + struct.pack("<II", 15, len(packed)) + packed


MAT: Mapping[str, Callable[[], bytes]] = {
    "a bomb of zeros": lambda: _mat(25_000_000),
    "2^31 numbers that are not there": lambda: _mat(10, 2**31 - 1),
    "fewer numbers than none": lambda: _mat(10, -5),
    "a head alone": lambda: _mat(0)[:128],
}


def cases() -> Iterator[Hostile]:
    """Every file of data."""
    for what, damage in NPZ.items():
        yield Hostile(("export", "a.npz", "--csv"), _damaged("a.npz", damage), f"trajectory: {what}")
        if what in DRAWN:
            yield Hostile(("export", "a.npz", "--png"), _damaged("a.npz", damage), f"trajectory: {what}, drawn")
            yield Hostile(("export", "a.npz", "--mcap"), _damaged("a.npz", damage), f"trajectory: {what}, logged")
    for what, damage in GAIT.items():
        yield Hostile(("bound", "--gait", "./a.json", "--cycles", "1"), _damaged("a.json", damage), f"gait: {what}")
    for what, content in ANSWERS.items():
        yield Hostile(("references", "a.json"), put("a.json", content), f"answers: {what}")
    for what, damage in CSV.items():
        yield Hostile(("identify", "a.csv"), _damaged("a.csv", damage), f"log: {what}")
    for what, content in MAT.items():
        yield Hostile(("identify", "a.mat"), put("a.mat", content), f"log of MATLAB: {what}")
    for what, damage in NPZ.items():
        yield Hostile(("replay", "crank_hopper", "a.npz"), _damaged("a.npz", damage), f"log of NumPy: {what}")
    for what, damage in CSV.items():
        yield Hostile(("replay", "crank_hopper", "a.csv"), _damaged("a.csv", damage), f"log of hops: {what}")
    for words, name, first in (
        (("export", "a.npz", "--csv"), "a.npz", b"PK\x03\x04"),
        (("bound", "--gait", "./a.json"), "a.json", b"{}"),
        (("references", "a.json"), "a.json", b"{}"),
        (("identify", "a.csv"), "a.csv", b"time_s,knee_rad\n"),
        (("identify", "a.mat"), "a.mat", _mat(10)),
        (("replay", "crank_hopper", "a.mcap"), "a.mcap", b"\x89MCAP0\r\n"),
    ):
        yield Hostile(words, sparse(name, first), f"{name} of 100 GB")


def _damaged(name: str, damage: Damage) -> Callable[[Path], None]:
    return put(name, lambda: damage(WHOLE[name]()))
