"""The documentation site: nothing public and no page is left out of it, and an example that fails says so."""

import argparse
import ast
import importlib
import json
import os
import posixpath
import re
import runpy
import sys
from pathlib import Path

import numpy as np
import pytest

import spear_pin
from spear_pin import hopping, load, simulate
from spear_pin.model.catalogue import GEARBOXES, MOTORS
from spear_pin.viz.player import record
from tests.viz.chromium import pixels

ROOT = Path(__file__).parents[1]
DOCS = ROOT / "docs"
PATHS = [path for path in DOCS.rglob("*.md") if path.relative_to(DOCS).parts[0] not in ("api", "gallery")]
PAGES = {path.relative_to(DOCS).with_suffix("").as_posix(): path.read_text(encoding="utf-8") for path in PATHS}
EXAMPLES = sorted((ROOT / "examples").glob("*.py"))


def entries(directive: str) -> list[tuple[str, str]]:
    """What stands in all directives of a name, options left out, with the page."""
    fence = rf"^(?:```\{{{directive}\}}|\.\. {directive}::)\n(.*?)^```$"
    lines = [
        (page, line.strip())
        for page, text in PAGES.items()
        for block in re.findall(fence, text, re.M | re.S)
        for line in block.splitlines()
    ]
    return [(page, line) for page, line in lines if line and ":" not in line]


def listed() -> set[str]:
    """What the tables of the API list."""
    return {entry for _, entry in entries("autosummary")}


def test_every_page_is_in_a_table_of_contents():
    found = sorted(posixpath.join(posixpath.dirname(page), entry) for page, entry in entries("toctree"))
    assert found == sorted({*PAGES, "gallery/index"} - {"index"})


PUBLISHED = """
accuracy adding_a_gait adding_a_robot architecture bench bounding coming_from compare design
engines_and_accuracy errata explore export families getting_started hardware hopping limits live
model motors notebooks notebooks/bound notebooks/hop notebooks/two_springs optimal_design payoff
published_legs push_test sensitivity source space speed sweeps uncertainty your_robot
""".split()  # addresses that pages had before they were sorted into four parts


def test_old_addresses_lead_to_pages(monkeypatch):
    monkeypatch.setattr(sys, "path", list(sys.path))
    monkeypatch.setenv("PYTHONPATH", "")
    redirects = runpy.run_path(str(DOCS / "conf.py"))["redirects"]
    assert {*redirects} == {*PUBLISHED} and not {*redirects} & {*PAGES}
    for old, new in redirects.items():
        page, suffix = posixpath.splitext(posixpath.normpath(posixpath.join(posixpath.dirname(old), new)))
        assert page in PAGES and suffix == ".html", old


def test_every_public_name_is_in_the_api():
    homes = {f"~{getattr(spear_pin, name).__module__}.{name}" for name in spear_pin.__all__}
    assert len(homes) == len(spear_pin.__all__)
    assert homes == {entry for entry in listed() if entry.startswith("~")}


def test_every_module_is_in_the_api():
    named = {entry for entry in listed() if not entry.startswith("~")}
    package = ROOT / "spear_pin"
    modules = {path.stem for path in package.glob("*.py")} | {
        path.parent.name for path in package.glob("*/__init__.py")
    }
    assert named == {f"spear_pin.{name}" for name in modules - {"__init__", "__main__", "cli", "urdf"}}


def test_the_places_between_which_a_page_includes_a_file_are_there():
    included = re.findall(r"^```\{include\} (\S+)\n(.*?)^```$", "\n".join(PAGES.values()), re.M | re.S)
    places = [
        (file, place)
        for file, options in included
        for place in re.findall(r'^:(?:start|end)-\w+: "(.*)"$', options, re.M)
    ]
    assert len(places) >= 2
    for file, place in places:
        assert place in (DOCS / file).read_text(encoding="utf-8"), f"{file}: {place}"


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda path: path.stem)
def test_an_example_says_what_it_is_for(example: Path):
    docstring = ast.get_docstring(ast.parse(example.read_text(encoding="utf-8"))) or ""
    assert "\n\nObjective: " in docstring


def test_the_limits_of_the_readme_are_explained():
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    items = re.search(r"^## What it does not do\n(.*?)^## ", readme, re.M | re.S)
    limits = [re.split(r"[:.]", item)[0] for item in re.findall(r"^- (.*)$", items[1], re.M)]
    assert limits == re.findall(r"^## (.*)$", PAGES["explanation/limits"], re.M)[: len(limits)]


@pytest.fixture
def extension(monkeypatch):
    """Imports an extension of the site by its name."""
    monkeypatch.syspath_prepend(str(DOCS / "_extensions"))
    return importlib.import_module


@pytest.fixture
def gallery(extension):
    return extension("gallery")


@pytest.mark.extra("sphinx")
class TestGallery:
    DRAWS = "from pathlib import Path\nPath('a.svg').write_text('<svg/>')\nprint('drawn')\n"

    @staticmethod
    def run(gallery, folder: Path, program: str):
        path = folder / "sketch.py"
        path.write_text(program, encoding="utf-8")
        example = gallery.Example(path, folder / "sketch")
        return gallery.run(example), example

    def test_shows_what_a_program_drew_and_printed(self, gallery, tmp_path):
        failure, example = self.run(gallery, tmp_path, f'"""Draw <a> thing.\n\nObjective: draw.\n"""\n{self.DRAWS}')
        assert failure is None and example.pictures == ["a.svg"]
        assert (example.folder / gallery.PRINTED).read_text() == "drawn\n"
        page = gallery.page(example)
        assert "Draw \\<a> thing.\n\nObjective: draw." in page and "](sketch/a.svg)" in page
        assert ":img-top: sketch/a.svg" in gallery.index([example])

    def test_runs_again_when_the_program_changed(self, gallery, tmp_path):
        _, example = self.run(gallery, tmp_path, self.DRAWS)
        os.utime(example.path, (2e9, 2e9))
        assert example.up_to_date, "by its content"
        example.path.write_text(f"{self.DRAWS}\n", encoding="utf-8")
        assert not example.up_to_date

    def test_runs_again_when_the_package_changed_where_it_was_read(self, gallery, tmp_path, monkeypatch):
        _, example = self.run(gallery, tmp_path, f"import spear_pin.words\n{self.DRAWS}")
        known = json.loads((example.folder / gallery.READ).read_text(encoding="utf-8"))
        assert "spear_pin" in known["places"] and "spear_pin/studies" not in known["places"]
        assert example.up_to_date
        true = gallery.kept.digest
        monkeypatch.setattr(
            gallery.kept, "digest", lambda folder: "other" if folder.name == "spear_pin" else true(folder)
        )
        assert not example.up_to_date

    def test_runs_again_with_other_libraries(self, gallery, tmp_path, monkeypatch):
        _, example = self.run(gallery, tmp_path, self.DRAWS)
        monkeypatch.setattr(gallery.kept, "LIBRARIES", ("numpy",))
        assert not example.up_to_date

    def test_names_a_program_that_fails(self, gallery, tmp_path):
        failure, example = self.run(gallery, tmp_path, f"{self.DRAWS}raise SystemExit('no such spring')\n")
        assert "sketch.py failed" in failure and "no such spring" in failure
        assert not example.up_to_date

    def test_wants_a_picture(self, gallery, tmp_path):
        failure, _ = self.run(gallery, tmp_path, "print('nothing to see')\n")
        assert failure == "sketch.py drew no picture"

    def test_shows_robots_of_examples_that_record_them(self, gallery, tmp_path):
        shown = {example.name: example.path for example in gallery.examples(tmp_path) if example.name in gallery.ROBOTS}
        assert tuple(shown) == gallery.ROBOTS
        assert all("record(" in path.read_text(encoding="utf-8") for path in shown.values())

    @pytest.mark.slow
    @pytest.mark.browser
    def test_a_card_shows_the_robot_on_its_page(self, gallery, tmp_path):
        robot = load("spear_ii", locked=["boom_x"])
        hop = simulate(hopping(robot), hopping(robot).guess(), cycles=1)
        example = gallery.Example(Path("another.py"), tmp_path / "hop")
        example.folder.mkdir()
        (example.folder / "hop.svg").write_text("<svg/>", encoding="utf-8")
        record(robot, hop, example.folder / "hop.html")
        assert gallery.thumbnail(example) == "another/hop.svg"
        seen = gallery.thumbnail(gallery.Example(Path("hop.py"), example.folder))
        picture = pixels((tmp_path / seen).read_bytes())
        assert picture.shape == (360, 480, 3) and (np.ptp(picture, axis=2) > 150).any(), "the spring is orange"

    def test_pages_that_play_are_recorded(self):
        played = re.findall(r"^```\{player\} (\S+) (\S+\.html)", "\n".join(PAGES.values()), re.M)
        assert len(played) >= 2
        for example, name in played:
            assert f'"{name}"' in (ROOT / "examples" / f"{example}.py").read_text(encoding="utf-8")

    def test_begins_where_the_page_of_examples_does(self, gallery, tmp_path):
        assert [example.name for example in gallery.examples(tmp_path)][:2] == ["dynamics_queries", "hop"]

    def test_has_every_example(self, gallery, tmp_path):
        assert {example.path for example in gallery.examples(tmp_path)} == set(EXAMPLES)


@pytest.mark.extra("sphinx")
def test_links_to_files_lead_to_the_pages_made_from_them(gallery):
    from links import redirected

    text = "[a](../examples/hop.py), [b](../spear_pin/model/robot.py), [c](../README.md), [d](model.md#contact)"
    assert (
        redirected(text)
        == "[a](gallery/hop.md), [b](api/spear_pin.model.robot.rst), [c](index.md), [d](model.md#contact)"
    )
    assert redirected("[a](../../examples/hop.py), [c](../../README.md)") == "[a](../gallery/hop.md), [c](../index.md)"


@pytest.mark.extra("sphinx")
class TestArchitecture:
    @pytest.fixture
    def drawn(self, extension):
        return extension("architecture")

    def test_every_module_is_on_the_plan(self, drawn):
        files = {path.stem for path in (ROOT / "spear_pin").rglob("*.py")} | {
            path.stem for path in (ROOT / "viz").rglob("*.py")
        }
        named = {name for floor in drawn.floors() for room in drawn.rooms(floor) for name in room.modules}
        assert files - {"__init__", "_version"} <= named
        plan = drawn.floor_plan()
        assert all(f">{floor}</text>" in plan for floor in ("cli", "viz", "studies", "gaits", "hybrid", "model"))
        assert plan.count("asks: ") == 5, "all but the lowest"

    def test_a_hop_goes_through_the_rules(self, drawn):
        path = drawn.path_of_a_hop()
        names = set()
        waiting = [path]
        while waiting:
            call = waiting.pop()
            names.add(call.name)
            waiting += call.calls
            assert call.says
        assert path.name == "hybrid.run.run"
        rules = (
            "start.start",
            "footing.fitness",
            "entry.at_once",
            "impact.routh",
            "latching.latch_values",
            "cycles.whole",
        )
        assert {f"hybrid.rules.{rule}" for rule in rules} <= names
        assert {"gaits.hopping.stance_law", "gaits.hopping.flight_law", "hybrid.strikes.strike_by_rule"} <= names


@pytest.mark.extra("sphinx")
class TestReference:
    @pytest.fixture
    def reference(self, extension):
        return extension("reference")

    def test_has_every_command_once(self, reference):
        names = [name for members in reference.groups().values() for name in members]
        assert sorted(names) == sorted(reference.parsers()) and {"hop", "push-test"} <= {*names}
        assert {*names} == {*reference.summaries()}

    def test_follows_the_groups_of_the_help(self, reference, monkeypatch):
        parser = reference.cli._parser()
        monkeypatch.setattr(reference.cli, "_parser", lambda: parser)
        monkeypatch.setattr(reference.subparsers(parser), "groups", {"one leg": ["hop"]}, raising=False)
        assert reference.groups() == {"one leg": ["hop"]}

    def test_has_the_options_with_their_units_and_defaults(self, reference):
        parser = reference.parsers()["hop"]
        options = {option.usage: option for group in reference.options(parser) for option in group.options}
        assert options["--stiffness N·m/rad"].default == "48.84"
        assert options["--open"].default == "" and options["--cycles N"].default == "11"
        assert not any("default:" in option.text or "--json" in option.usage for option in options.values())
        assert reference.options(reference.parsers()["dynamics"])[0].options[0].default == "required"
        assert reference.usage(parser).startswith("spear hop [")

    @pytest.mark.parametrize(
        ("said", "text", "default"),
        [
            ("sideways (default: 0); with --space", "sideways; with --space", "0"),
            ("folder (default: here)", "folder", "here"),
            ("default: sweep.zarr", "", "sweep.zarr"),
            ("of gears (default: 0.83, as of a GP 52 (C))", "of gears", "0.83, as of a GP 52 (C)"),
            ("joints held at zero", "joints held at zero", ""),
        ],
    )
    def test_takes_the_default_out_of_the_sentence(self, reference, said, text, default):
        action = argparse.ArgumentParser().add_argument("--x", help=said)
        assert reference.option_of(action, argparse.HelpFormatter("spear"))[1:] == (text, default)

    def test_indented_lines_of_a_description_are_code(self, reference):
        parser = argparse.ArgumentParser(description="do this; it takes `long`\n\nExample: it.\n  spear a\n  spear b")
        made = reference.described(parser)
        assert [each.astext() for each in made] == ["Do this; it takes long.", "Example: it.", "spear a\nspear b"]
        assert [each.tagname for each in made] == ["paragraph", "paragraph", "literal_block"]

    def test_tables_have_a_row_for_each(self, reference):
        rows = [(reference.code("work"), reference.inline("in `J`"))]
        made = reference.table(("Measure", "Unit"), rows, (50, 50))
        assert [entry.astext() for entry in made.findall(reference.nodes.entry)] == ["Measure", "Unit", "work", "in J"]


@pytest.mark.extra("sphinx")
def test_the_page_of_motors_has_every_number_of_the_catalogue(extension):
    motors = extension("motors")
    assert motors.entries() == {**MOTORS, **GEARBOXES}
    for entry in motors.entries().values():
        for name, number in entry.items():
            texts = ["".join(part.astext() for part in cell) for cell in motors.cells(name, number)]
            assert texts == [name, f"{number.value:.4g}", number.unit, number.source, number.verification]
