"""`spear report`."""

from dataclasses import replace

import pytest

from spear_pin.studies.audit.statements import STATEMENTS
from spear_pin.viz.report import making
from tests.cli.calls import loads, printed, refused, run, words


@pytest.fixture(autouse=True)
def cache(tmp_path_factory, monkeypatch):
    folder = tmp_path_factory.mktemp("cache")
    monkeypatch.setenv("XDG_CACHE_HOME", str(folder))
    return folder


def test_page_and_rows(capsys, tmp_path):
    shown = printed(capsys, "report", "--only", "fig-2.1", "kinetic-energy", "--out", tmp_path)
    page = tmp_path / "report.html"
    assert shown["files"] == [str(page)] and shown["bytes"] == page.stat().st_size
    assert shown["counts"] == {
        "agrees": 0, "differs": 1, "by construction": 2, "cannot be known": 0, "failed": 0
    }  # fmt: skip
    row = next(row for row in shown["rows"] if row["id"] == "kinetic-energy")
    assert row["verdict"] == "differs" and row["place"] == "(3.14)" and row["unit"] == "kg·m²"
    assert row["found"] == pytest.approx([0.1636, 0.1932], abs=1e-4)
    assert "print(printed_equations.effective_inertia())" in row["command"]


def test_alternatives(capsys, tmp_path):
    (row,) = printed(capsys, "report", "--only", "damping-in-flight", "--out", tmp_path)["rows"]
    assert row["assumes"] == ["touchdown"] and row["verdict"] == "differs"
    assert [(other["holds"], other["found"] > 3) for other in row["others"]] == [(False, True)] * 2
    assert "0.9 rad" in row["others"][0]["assumed"]


def test_text(capsys, tmp_path):
    status, out, err = run(capsys, "report", "--only", "table-3.1", "--out", tmp_path)
    assert (status, err) == (0, "")
    assert (
        "1 cannot be known" in out
        and "report.html" in out
        and [path.name for path in tmp_path.iterdir()] == ["report.html"]
    )


@pytest.mark.parametrize("suffix", ["svg", "pdf", "png"])
@pytest.mark.slow
def test_figures(capsys, tmp_path, suffix):
    shown = printed(capsys, "report", "--only", "fig-2.9", "--figures", suffix, "--out", tmp_path)
    assert (tmp_path / "report_figures" / f"fig-2.9.{suffix}").is_file() and len(shown["files"]) == 2


def test_list(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    ids = printed(capsys, "report", "--list")["ids"]
    assert len(ids) == len(set(ids)) > 100 and {"fig-2.1", "table-3.1", "kinetic-energy"} <= set(ids)
    assert run(capsys, "report", "--list", "--only", "kinetic-energy") == (0, "kinetic-energy\n", "")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.slow
def test_list_loads_nothing_that_computes():
    heavy = {"scipy.integrate", "scipy.optimize", "scipy.signal", "scipy.stats", "heyoka", "zarr"}
    assert not heavy & loads("report", "--list")


def test_an_unknown_part(capsys):
    text = refused(capsys, "report", "--only", "kinetic-enrgy")
    assert ": kinetic-energy" in text and "'help' in its place lists all" in text and len(text) < 200


def test_cache(capsys, tmp_path, cache):
    options = ["report", "--only", "fig-2.1", "--out", tmp_path]
    run(capsys, *options, "--no-cache")
    assert list(cache.rglob("*")) == []
    first = printed(capsys, *options)
    page = (tmp_path / "report.html").read_bytes()
    assert len(list((cache / "spear_pin").iterdir())) == 3  # two findings and a figure
    assert printed(capsys, *options) == first
    assert (tmp_path / "report.html").read_bytes() == page


def test_a_failure_is_a_row_and_ends_with_status_2(capsys, tmp_path, monkeypatch):
    def broken():
        raise ZeroDivisionError("nothing to divide by")

    first, *others = STATEMENTS
    monkeypatch.setattr(making, "STATEMENTS", (replace(first, study=broken), *others))
    status, out, _ = run(capsys, "report", "--only", first.id, "spring-engaged", "--out", tmp_path)
    assert status == 2
    assert "1 by construction, 1 failed" in out and "nothing to divide by" in out
    assert "nothing to divide by" in (tmp_path / "report.html").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("options", "named"),
    [(["--only", "fig-9.9"], "fig-9.9"), (["--figures", "gif"], "gif"), (["--out", "nowhere"], "nowhere")],
    ids=words,
)
def test_refused(capsys, tmp_path, monkeypatch, options, named):
    monkeypatch.chdir(tmp_path)
    assert named in refused(capsys, "report", *options)
    assert list(tmp_path.iterdir()) == []
