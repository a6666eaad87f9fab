"""The README and the documentation: every Python block runs, every link and picture is there, commands fit."""

import re
import runpy
import shlex
import subprocess
import sys
from pathlib import Path

import pytest
from PIL import Image

from benchmarks import beside
from spear_pin.cli import _parser, main
from spear_pin.errors import MissingProgram
from tests.documentation import NOTEBOOKS, PAGES, ROOT, blocks, fenced

README = PAGES[0].read_text(encoding="utf-8")

# by the text of a block
EXTRAS = {
    "mujoco": "mujoco",
    "pydrake": "pydrake",
    "dask": "distributed",
    "studies.sweep": "heyoka",
    "collocated": "casadi",
    ".sensitivity(": "heyoka",
    "identify_motion(": "heyoka",
    "optimize_design(": "heyoka",
    "continue_gait(": "heyoka",  # without it some minutes
    'load("solo12"': "example-robot-data",
}
SLOW = {
    *("gait_of_your_own.md-1", "describe_a_robot.md-4", "describe_a_robot.md-5", "play_a_motion.md-1", "bound.md-1"),
    *("compare.md-1", "choose_spring_and_motor.md-1", "export.md-3", "first_hop.md-3"),
    *("hardware.md-1", "hardware.md-2", "motors.md-2"),
    *("quadruped_in_space.md-2", "make_a_figure.md-1", "gait_of_your_own.md-2"),
    *("measures.md-2", "move_in_space.md-1", "identify_a_knee.md-1", "fit_a_log.md-1"),
}
# a server, tested in a browser; made by the gate as a whole; an example of the site; a minute of timing
ELSEWHERE = {"explore", "report", "examples/hop.py", "benchmarks.beside"}
QUIET = pytest.mark.filterwarnings("default")  # a cluster's warnings are not ours


def marked(name: str, block: str):
    """A block as a test's parameter, with what it needs and whether it takes long."""
    marks = [pytest.mark.extra(module) for text, module in EXTRAS.items() if text in block]
    marks += [QUIET] if "dask" in block else []
    marks += [pytest.mark.slow] * (name in SLOW)
    return pytest.param(block, id=name, marks=marks)


BLOCKS = [marked(name, block) for name, block in blocks().items()]
LINKS = [
    pytest.param(page, link, id=f"{page.name}-{link}")
    for page in [*PAGES, *NOTEBOOKS]
    for link in dict.fromkeys(re.findall(r"\]\(([^)]+)\)", page.read_text(encoding="utf-8")))
]


def anchors(page: Path) -> set[str]:
    """Fragments of a page's headings."""
    text = page.read_text(encoding="utf-8")
    headings = re.findall(r"^#+ (.+)$", text, re.M)
    if "```{commands}" in text:  # makes a section for each
        headings += [f"spear {name}" for action in _parser()._subparsers._group_actions for name in action.choices]
    return {re.sub(r"[^\w -]", "", heading).lower().replace(" ", "-") for heading in headings}


@pytest.mark.parametrize("block", BLOCKS)
def test_block_runs(block: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MPLBACKEND", "Agg")
    monkeypatch.syspath_prepend(str(ROOT / "examples"))
    script = tmp_path / "block.py"
    script.write_text(block, encoding="utf-8")
    try:
        runpy.run_path(str(script))
    except MissingProgram as missing:
        pytest.skip(f"{missing}: not here")


def first_commands():
    """The first commands of pages that begin with some: but of results, and what installs, serves or runs elsewhere."""
    for page in PAGES[1:]:
        begins = re.search(r"^```(\w+)\n", page.read_text(encoding="utf-8"), re.M)
        if page.parent.name == "results" or begins is None or begins[1] != "sh":
            continue
        lines = [shlex.split(line, comments=True) for line in fenced(page, "sh")[0].splitlines()]
        lines = [words for words in lines if words[0] in ("spear", "python") and not ELSEWHERE & {*words}]
        needs = [pytest.mark.extra("example-robot-data", "casadi")] if "solo12" in str(lines) else []
        if lines:
            yield pytest.param(lines, id=page.name, marks=needs)


@pytest.mark.slow
@pytest.mark.parametrize("lines", [*first_commands()])
def test_the_first_commands_of_a_page_run(lines, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MPLBACKEND", "Agg")
    monkeypatch.setenv("PYTHONPATH", str(ROOT))
    for program, *words in lines:
        if program == "python":
            subprocess.run([sys.executable, *words], check=True, capture_output=True)
        else:
            assert main([word for word in words if word != "--open"]) == 0, capsys.readouterr().err


def test_the_readme_shows_python():
    assert BLOCKS[0].id == "README.md-1"
    assert SLOW <= {block.id for block in BLOCKS}


@pytest.mark.parametrize(("page", "link"), LINKS)
def test_link_leads_somewhere(page: Path, link: str):
    path, _, fragment = link.partition("#")
    target = page.parent / path if path else page
    assert target.is_file(), link
    assert not fragment or fragment in anchors(target), link


def test_the_readme_gives_the_two_commands():
    shell = [line for block in fenced(PAGES[0], "sh") for line in block.splitlines()]
    assert shell == [
        "python3 -m venv .venv && .venv/bin/pip install -q . && .venv/bin/spear hop",
        "python3 -m venv .venv && .venv/bin/pip install -q '.[test]' && .venv/bin/python -m pytest",
    ]
    assert README.index("-m pytest") == README.index(shell[1]) + shell[1].index("-m pytest"), "the gate takes the first"


def test_the_table_of_other_tools_has_the_rows_that_are_measured():
    page = (ROOT / "docs" / "explanation" / "other_tools.md").read_text(encoding="utf-8")
    table = page.partition("## Why not")[2].partition("##")[0]
    assert tuple(re.findall(r"^\| ([^|]+?) \|", table, re.M)[1:]) == beside.ROWS


def test_what_moves_on_top_is_small_and_repeats():
    films = re.findall(r"\]\((\S+\.gif)\)", README.partition("```")[0])
    assert [Path(film).stem for film in films] == ["hop", "bound"]
    assert sum((ROOT / film).stat().st_size for film in films) < 1_500_000
    for film in films:
        with Image.open(ROOT / film) as image:
            assert image.n_frames > 20 and image.info["loop"] == 0


def test_the_modules_that_documents_name_exist():
    for page in PAGES:
        for command in re.findall(r"python -m ([\w.]+)|python ([\w/]+\.py)", page.read_text(encoding="utf-8")):
            name = shlex.split(command[0] or command[1])[0]
            path = ROOT / (name if command[1] else name.replace(".", "/") + ".py")
            package = path.with_suffix("") / "__main__.py"
            assert name == "pytest" or path.is_file() or package.is_file(), f"{page.name}: {name}"


def test_every_example_is_on_the_page_of_examples():
    examples = sorted(path.name for path in (ROOT / "examples").glob("*.py"))
    page = (ROOT / "docs" / "how_to" / "examples.md").read_text(encoding="utf-8")
    assert examples == sorted(re.findall(r"\]\(\.\./\.\./examples/(\w+\.py)\)", page))
