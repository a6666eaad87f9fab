"""Files as other people write them: read rightly, or refused in one line that names the file."""

import re

import numpy as np
import pytest

from spear_pin.errors import BadFile, SpearError
from spear_pin.studies.identification import read_record
from tests.studies.identification.files import ANGLE, T, changed, table, written

KNEE = "'column 2' names no unit: taken as rad"
UNENDED = "the last line has no end: it may be cut off"
SAME = {  # content: remarks
    "plain": (table(), ()),
    "CRLF": (table(end="\r\n"), ()),
    "CR": (table(end="\r"), ()),
    "no newline at the end": (table()[:-1], (UNENDED,)),
    "byte order mark": ("\ufeff" + table(), ()),
    "byte order mark, no header": ("\ufeff" + table(head=""), (KNEE,)),
    "semicolons": (table(separator=";"), ()),
    "decimal comma": (table(separator=";", decimal=","), ()),
    "decimal comma, tabs": (table(separator="\t", decimal=","), ()),
    "tabs": (table(separator="\t"), ()),
    "blanks": (table(separator="   "), ()),
    "blanks around": (table(" time_s , knee_rad ", row="  {t:.3f} {s} {a:.6f} "), ()),
    "quoted": (table(row='"{t:.3f}"{s}"{a:.6f}"'), ()),
    "quoted header": (table('"time_s","knee_rad"'), ()),
    "no header": (table(head=""), (KNEE,)),
    "comments": ("# one\n#two\n\n" + table(), ()),
    "comments with odd line ends": ("# one\x0ctwo\x1cthree\u2028\n" + table(), ()),
    "comment inside": (changed(50, "0.049,1.248731 # hello"), ()),
    "trailing separators": (table(row="{t:.3f}{s}{a:.6f}{s}"), ()),
    "a nameless column of nothing": (table("time_s,knee_rad,", row="{t:.3f}{s}{a:.6f}{s}"), ()),
    "nameless columns of nothing": (table(",time_s,,knee_rad,,", row="{s}{t:.3f}{s}{s}{a:.6f}{s}{s}"), ()),
    "no header, trailing separators": (table("", row="{t:.3f}{s}{a:.6f}{s}"), (KNEE,)),
    "decimal comma, quoted": (table(row='"{t:.3f}"{s}"{a:.6f}"', decimal=","), ()),
    "decimal comma, quoted, blanks": (table(row=' "{t:.3f}" {s} "{a:.6f}" ', decimal=","), ()),
    "exponents": (table(row="{t:.3e}{s}{a:.6e}"), ()),
    "plus signs": (table(row="{t:+.3f}{s}{a:+.6f}"), ()),
    "empty lines": (table().replace("\n", "\n\n"), ()),
    "units below the header": (changed(0, "time,knee\ns,rad"), ()),
    "units in brackets below the header": (changed(0, "time;knee\n[s];[rad]", table(separator=";", decimal=",")), ()),
    "units below and beside": (changed(0, "time_s,knee_rad\nseconds,radians"), ()),
    "a unit below one name only": (changed(0, "time_s,knee\n,rad"), ()),
    "unit names alone": (changed(0, "s,rad"), ()),
    "names with blanks before units, blanks": (changed(0, "time [s]  knee (rad)", table(separator="  ")), ()),
    "a header of NumPy": ("# made by a logger\n" + changed(0, "# time_s knee_rad", table(separator=" ")), ()),
    "a title": ("Push test 3\n" + table(), ("above the table: 'Push test 3'",)),
    "titles with commas and numbers": (
        "Push test,3\noperator,nobody\ndate,2026,11\n\n" + table(),
        ("'Push test,3', 'operator,nobody', 'date,2026,11'",),
    ),
    "a title with a quote": ('a rod of 5" \n' + table(), ("a rod of 5",)),
    "a title with a byte order mark, semicolons": (
        "\ufeffRüttler; Versuch 3\r\n" + table(separator=";", decimal=",", end="\r\n"),
        ("above the table: 'Rüttler; Versuch 3'",),
    ),
    "a title, names, units, tabs": (
        "Export\n" + changed(0, "time\tknee\nsec\trad", table(separator="\t")),
        ("above the table: 'Export'",),
    ),
    "many titles": ("".join(f"line {i}\n" for i in range(40)) + table(), ("'line 0'.* and 36 more",)),
}
DROPPED = {  # what line 50 becomes: the sample of 0.049 s is lost
    "text": changed(50, "0.049,abc"),
    "NaN": changed(50, "0.049,NaN"),
    "blank cell": changed(50, "0.049,"),
    "blank time": changed(50, ",1.2"),
    "short line": changed(50, "0.049"),
    "infinite": changed(50, "0.049,inf"),
    "beyond floats": changed(50, "0.049,1e400"),
    "beyond integers": changed(50, "0.049," + "9" * 400),
    "two numbers in one": changed(50, "0.049,1.2.3"),
    "quoted thousands": changed(50, '0.049,"1,000.5"'),
    "decimal comma and text": changed(50, "0,049;--", table(separator=";", decimal=",")),
    "decimal comma missing in the last row looked at": changed(
        50, "0,049;--", changed(20, "0,019;1", table(separator=";", decimal=","))
    ),
}
REFUSED = {
    "empty": ("", "the file is empty"),
    "white": (" \n\t\n", "the file is empty"),
    "only comments": ("# a\n# b\n", "no rows"),
    "only header": ("time_s,knee_rad\n", "0 rows have a time"),
    "only header, no newline": ("time_s,knee_rad", "0 rows have a time"),
    "one column": (table("time_s", row="{t:.3f}"), "a column is missing: there is only time_s"),
    "one number": ("1\n", "a column is missing"),
    "three columns": (table("time_s,hip_rad,knee_rad", row="{t}{s}0{s}{a}"), "which column is the knee's"),
    "nameless third": (table("time_s,knee_rad,", row="{t}{s}{a}{s}3"), "which column is the knee's.*column 3"),
    "a cell with its unit": (
        table("time,knee", row="{t:.3f} s{s}{a:.6f} rad"),
        "'time' holds '0.000 s' in row 1: write 0.000 alone, and the unit in the column's name",
    ),
    "an exponent of Fortran": (
        table(row="{t:.3f}D+00{s}{a:.6f}"),
        r"'time_s' holds '0.000D\+00' in row 1: write 0.000E\+00$",
    ),
    "American dates": (
        table(row="01/31/2024 10:00:{t:06.3f}{s}{a:.6f}"),
        "'time_s' holds '01/31/2024 10:00:00.000' in row 1: write seconds, or a date with a time of day as 2024",
    ),
    "words": (table(row="{t}{s}none at all"), "'knee_rad' holds no number, but 'none at all' in row 1: write a number"),
    "times of day for angles": (table(row="{t}{s}00:00:01"), "column 'knee_rad' holds dates or times of day.*--column"),
    "commas of thousands": (table(row='"{t:.3f}"{s}"1,000"'), "'knee_rad' holds no number, but '1,000' in row 1"),
    "same name twice": (table("knee_rad,knee_rad"), ":1: two columns have the same name"),
    "too many fields below a title": ("a\n" + changed(50, "0.049,1.2,3"), "Expected 2 fields in line 52, saw 3"),
    "a unit below that is none": (
        changed(0, "time_s,knee\ns,furlong"),
        "unit of 'knee', column 'knee' of .*: 'furlong'; valid: rad",
    ),
    "two units": (
        changed(0, "time_s,knee_rad\ns,deg"),
        "'knee_rad' is in rad, and in deg as the row below says; say which by --unit",
    ),
    "too many fields": (changed(50, "0.049,1.2,3"), "Expected 2 fields in line 51, saw 3"),
    "too many fields throughout": (table(row="{t}{s}{a}{s}7"), "more fields than the 2 columns"),
    "decimal comma without semicolons": (table(decimal=","), "more fields than the 2 columns"),
    "quote left open": (changed(50, '0.049,"1.2'), "EOF inside string"),
    "dates": (
        table(row="2026-01-01{s}{a}"),
        "0 rows have a time of their own.*'2026-01-01' in row 1: write seconds, or a date",
    ),
    "truth values": (table(row="{t}{s}True"), "'knee_rad' holds no number, but 'True' in row 1"),
    "mostly NaN": (table().replace(",1.", ",n1."), "210 of 400 rows hold no angle"),
    "time goes back": (changed(50, "0.01,1.0"), "time goes back after row 49, by 0.038 s"),
    "time stands still": (table(row="0.5{s}{a}"), "1 rows have a time of their own; expected at least 50"),
    "few rows": (table()[:500], "32 rows have a time of their own; expected at least 50"),
    "huge": (changed(50, "0.049,1e308"), "reaches 1e\\+308 rad"),
    "UTF-16": (table().encode("utf-16"), "not a text file"),
    "UTF-16 without mark": (table().encode("utf-16-le"), "not a text file"),
    "latin-1": (table("time_s,angle [°]").encode("latin-1"), "not a text file"),
    "latin-1 far down": (table().encode() + b"# \xb0\n" + b"0.5,\xb0\n", "not a text file|not a table"),
    "latin-1 beyond the head": (
        table().encode() + b"0.5,1 # \n" * 10_000 + b"0.6,\xb0\n",
        "not a table of numbers: .*utf-8",
    ),
    "binary": (bytes(range(256)) * 10, "not a text file"),
    "zeros": (bytes(1000), "the file is empty"),
    "zero inside": (changed(50, "0.049,1\0"), "not a text file"),
    "a line without end": (b"7" * 200_000, "not a text file"),
    "HTML": ("<!DOCTYPE html>\n<p>404, not found</p>\n", "have a time|no number|column"),
}


def one_line(error, path):
    """Checks the error's text."""
    text = str(error)
    assert str(path) in text and "\n" not in text and len(text) < 400
    return text


@pytest.mark.parametrize("name", SAME)
def test_same(name, tmp_path):
    content, remarks = SAME[name]
    record = read_record(path := written(tmp_path, content))
    np.testing.assert_array_equal(record.t, T)
    np.testing.assert_allclose(record.angle, ANGLE, rtol=0, atol=5.1e-7)
    assert len(record.remarks) == bool(remarks)
    assert all(re.search(text, remark) and str(path) in remark for remark in record.remarks for text in remarks)


@pytest.mark.parametrize("name", DROPPED)
def test_dropped(name, tmp_path):
    record = read_record(written(tmp_path, DROPPED[name]))
    np.testing.assert_array_equal(record.t, np.delete(T, 49))
    expected = np.delete(ANGLE, 49)
    if "last row" in name:
        expected[19] = 1.0
    np.testing.assert_allclose(record.angle, expected, rtol=0, atol=5.1e-7)
    assert len(record.remarks) == 1
    assert re.search(
        "'knee_rad' holds no number in 1 of 400 rows|dropped 1 of 400 rows without a time", record.remarks[0]
    )


@pytest.mark.parametrize("name", REFUSED)
def test_refused(name, tmp_path):
    content, problem = REFUSED[name]
    path = written(tmp_path, content)
    with pytest.raises(SpearError, match=problem) as caught:
        read_record(path)
    one_line(caught.value, path)


MOMENTS = {
    "ISO 8601": "2024-01-31T23:59:{t:09.6f}",
    "with a blank": "2024-01-31 23:59:{t:09.6f}",
    "of universal time": "2024-01-31T23:59:{t:09.6f}Z",
    "of a zone": "2024-01-31T23:59:{t:09.6f}+01:30",
    "of a zone in hours": "2024-01-31T23:59:{t:09.6f}-05",
    "with slashes": "2024/01/31 23:59:{t:09.6f}",
    "German": "31.01.2024 23:59:{t:09.6f}",
    "times of day": "23:59:{t:09.6f}",
    "times of day before noon": "9:59:{t:09.6f}",
}


@pytest.mark.parametrize("separator", [";", ",", "\t"])
@pytest.mark.parametrize("name", MOMENTS)
def test_dates_and_times_of_day(name, separator, tmp_path):
    rows = [f"{MOMENTS[name].format(t=59.8 + t)}|{a:.6f}" for t, a in zip(T[:100], ANGLE[:100], strict=True)]
    text = "\n".join(["time|knee_rad", *rows, ""]).replace("|", separator)
    record = read_record(written(tmp_path, text))
    np.testing.assert_allclose(record.t, T[:100], rtol=0, atol=3e-7)
    assert record.remarks == ()
    if separator == ";":
        commas = re.sub(r"\.(?=\d{6})", ",", text)
        np.testing.assert_array_equal(read_record(written(tmp_path, commas)).t, record.t)


def test_past_midnight(tmp_path):
    clocks = [f"23:59:{59.8 + t:06.3f}" if t < 0.1995 else f"00:00:{t - 0.2:06.3f}" for t in T]
    text = "".join(f"{clock},{a}\n" for clock, a in zip(clocks, ANGLE, strict=True))
    record = read_record(written(tmp_path, "time,knee_rad\n" + text))
    np.testing.assert_allclose(record.t, T, rtol=0, atol=1e-7)


def test_units_that_dates_do_not_have_are_told(tmp_path):
    path = written(tmp_path, table("time_ms,knee_rad", row="2024-01-31T10:00:{t:06.3f}{s}{a:.6f}"))
    record = read_record(path)
    np.testing.assert_allclose(record.t, T, rtol=0, atol=3e-7)
    assert "'time_ms' holds dates or times of day" in record.remarks[0] and len(record.remarks) == 1


def test_repeated_times_are_dropped(tmp_path):
    record = read_record(written(tmp_path, changed(51, "0.049,6.0")))
    np.testing.assert_array_equal(record.t, np.delete(T, 50))
    np.testing.assert_allclose(record.angle, np.delete(ANGLE, 50), rtol=0, atol=5.1e-7)
    assert "dropped 1 rows that repeat a time" in record.remarks[0]


def test_cut_off(tmp_path):
    text = table()
    for length in range(len(text) - 40, len(text)):  # at any place of the last lines
        record = read_record(written(tmp_path, text[:length]))
        assert 396 <= record.t.size <= 400
        np.testing.assert_array_equal(record.t[:-1], T[: record.t.size - 1])
        np.testing.assert_allclose(record.angle[:-1], ANGLE[: record.t.size - 1], rtol=0, atol=5.1e-7)
        whole = text[length - 1] == "\n"
        assert any(UNENDED in remark for remark in record.remarks) != whole


def test_rows_swallowed_by_quotes_are_told(tmp_path):
    record = read_record(written(tmp_path, changed(90, '0.089,"1.0', changed(50, '0.049,"1.0'))))
    assert record.t.size < 400 and np.isin(record.t, T).all()
    assert any("holds no number in 1 of" in remark for remark in record.remarks)
    assert any("gaps between samples, the longest 0.042 s" in remark for remark in record.remarks)


def test_word_late_in_a_long_file(tmp_path):
    count = 600_000  # several chunks
    lines = [f"{i / 1000:.3f};1,{i % 10}" for i in range(count)]
    lines[550_000] = "550.000;--"
    text = "time_s;knee_rad\n" + "\n".join(lines).replace(".", ",") + "\n"
    record = read_record(written(tmp_path, text))
    np.testing.assert_allclose(record.t, np.delete(np.arange(count), 550_000) / 1000, rtol=1e-15)
    np.testing.assert_allclose(record.angle, np.delete(1 + np.arange(count) % 10 / 10, 550_000), rtol=1e-15)
    assert len(record.remarks) == 1 and "row 550001" in record.remarks[0]


def test_folder_and_nothing(tmp_path):
    for path in (tmp_path, tmp_path / "none.csv", tmp_path / "none.mat"):
        with pytest.raises(BadFile, match="cannot be read: (Is a directory|No such file)") as caught:
            read_record(path)
        one_line(caught.value, path)


def fuzzed(seed):
    """The good record with some damage, or none of it at all."""
    rng = np.random.default_rng(seed)
    if seed % 4 == 0:
        return rng.integers(0, 256, rng.integers(1, 3000), np.uint8).tobytes()
    content = bytearray(table(decimal=".,"[seed % 2], separator=",;\t "[seed // 2 % 4]).encode())
    marks = b"0123456789.,;-+eE\"'#\n\r\t \0xnaif\xff"
    for _ in range(rng.integers(1, 4)):
        i = int(rng.integers(len(content) if seed % 3 else 60))
        kind = rng.integers(4)
        if kind == 0:
            content[i] = marks[rng.integers(len(marks))]
        elif kind == 1:
            content[i:i] = bytes(marks[k] for k in rng.integers(0, len(marks), rng.integers(1, 6)))
        elif kind == 2:
            del content[i : i + int(rng.integers(1, 40))]
        else:
            content[i:i] = content[i : i + int(rng.integers(1, 200))]
    return bytes(content)


@pytest.mark.slow
def test_fuzz(tmp_path):
    read = 0
    for seed in range(500):
        path = written(tmp_path, fuzzed(seed))
        try:
            record = read_record(path)
        except SpearError as error:
            one_line(error, path)
            continue
        read += 1
        assert record.t.shape == record.angle.shape and record.t.size >= 50
        assert np.isfinite(record.t).all() and np.isfinite(record.angle).all()
        assert (np.diff(record.t) > 0).all() and np.abs(record.angle).max() <= 2 * np.pi
    assert 50 < read < 450


def test_a_cell_of_a_million_digits_takes_no_time():
    """The patterns of units and dates would take hours."""
    from spear_pin.studies.tables.cells import find_remedy

    assert find_remedy("9" * 1_000_000) == "write a number"
    assert find_remedy("1.5 V") == "write 1.5 alone, and the unit in the column's name, as in 'time [s]'"
