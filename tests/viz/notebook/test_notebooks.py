"""The notebooks of the docs, executed as nbconvert does it, in a real browser."""

import json
import os
import re
import subprocess
import sys
import time
from pathlib import Path

import pytest

from tests.viz import chromium

ROOT = Path(__file__).parents[3]
NOTEBOOKS = ROOT / "docs" / "tutorials" / "notebooks"
WANTED = {  # of each page: cards, figures and frames
    "hop": (["spear_ii", "hopping", "Motion of spear_ii"], 1, 1),
    "two_springs": (["hopping", "hopping"], 1, 1),
    "bound": (["bounding"], 2, 1),
}

pytestmark = [
    pytest.mark.slow,
    pytest.mark.browser,
    pytest.mark.extra("nbconvert", "ipykernel"),
    pytest.mark.skipif(chromium.find() is None, reason="no Chromium here"),
]


def notebook(path: Path) -> dict:
    """A page of MyST text as Jupyter has it: its cells of code."""
    sources = re.findall(r"^```\{code-cell\} ipython3\n(.*?)^```$", path.read_text(encoding="utf-8"), re.M | re.S)
    empty = {"cell_type": "code", "execution_count": None, "metadata": {}, "outputs": []}
    cells = [{**empty, "id": f"cell-{i}", "source": source} for i, source in enumerate(sources)]
    kernel = {"kernelspec": {"name": "python3", "display_name": "Python 3", "language": "python"}}
    return {"nbformat": 4, "nbformat_minor": 5, "metadata": kernel, "cells": cells}


def test_every_notebook_is_executed_here():
    assert {path.stem for path in NOTEBOOKS.glob("*.md")} == set(WANTED)


@pytest.mark.parametrize("name", WANTED)
def test_shows_player_plots_and_tables(name, tmp_path):
    source, page = tmp_path / "shown.ipynb", tmp_path / "shown.html"
    source.write_text(json.dumps(notebook(NOTEBOOKS / f"{name}.md")), encoding="utf-8")
    command = [sys.executable, "-m", "nbconvert", "--execute", "--to", "html", "--template", "basic", str(source)]
    paths = os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")])
    # the kernel's own backend shows figures, another that is set here would not
    environment = {name: value for name, value in os.environ.items() if name != "MPLBACKEND"} | {"PYTHONPATH": paths}
    done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    titles, figures, frames = WANTED[name]
    with chromium.Browser() as browser:
        browser.send("Page.navigate", page=True, url=page.as_uri())
        deadline = time.monotonic() + 30.0
        played = (
            "document.readyState === 'complete'"
            " ? [...document.querySelectorAll('iframe')].map(frame => frame.contentWindow.player?.time ?? 0) : []"
        )
        while not all(times := browser.run(played)) or not times:
            assert time.monotonic() < deadline, browser.errors
            time.sleep(0.2)
        assert len(times) == frames
        assert browser.run("[...document.querySelectorAll('p > b')].map(each => each.textContent)") == titles
        assert browser.run("[...document.images].filter(each => each.naturalWidth > 400).length") == figures
        assert browser.run("document.querySelectorAll('svg[role=img]').length") >= len(titles)
        assert browser.run("[...document.querySelectorAll('svg')].every(each => each.clientWidth > 20)")
        assert not [error for error in browser.errors if "favicon" not in error]
        assert all(address.split(":")[0] in ("file", "data", "blob", "about") for address in browser.requests)
