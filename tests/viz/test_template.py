"""The templates of the pages: what they are given is escaped, and what they ask for must be given."""

import json
from importlib.resources import files
from pathlib import Path

import pytest
from jinja2 import UndefinedError
from lxml import etree

from spear_pin.viz.template import asset, environment, licences, script_json
from tests.viz.samples import ODD

ROOT = Path(str(files("spear_pin.viz")))
SCRIPTS = sorted(path.relative_to(ROOT).as_posix() for suffix in ("js", "css") for path in ROOT.rglob(f"*.{suffix}"))


@pytest.mark.parametrize("name", ["player.html", "explore/page.html"])
def test_odd_words_are_shown_as_they_are(name):
    given = {"title": ODD, "kind": "hop", "notes": []}
    tree = etree.HTML(environment().get_template(name).render(title=ODD, data=given))
    assert len(tree.xpath("//script")) == 3 and not tree.xpath("//b")
    assert set(tree.xpath("//h1/text()")) <= {ODD, "SPEAR-II hopping"}
    assert json.loads(tree.xpath("//script[@id='data']/text()")[0]) == given


def test_what_every_page_has_is_written_once():
    sources = {path.relative_to(ROOT).as_posix(): path.read_text(encoding="utf-8") for path in ROOT.rglob("*.html")}
    for part, owner in {"<!doctype": "page.html", 'id="data"': "page.html", "<dialog": "viewer.html"}.items():
        assert [name for name, text in sources.items() if part in text.lower()] == [owner], part


@pytest.mark.parametrize("name", ["player.html", "explore/page.html"])
def test_a_page_begins_with_its_type(name):
    assert (
        environment()
        .get_template(name)
        .render(title="A hop", data={"kind": "hop", "notes": []})
        .startswith("<!DOCTYPE html>\n<html")
    )


@pytest.mark.parametrize("name", ["player.html", "report/page.html"])
def test_what_is_not_given_is_not_left_out(name):
    ignored = dict.fromkeys(("blocks", "command", "drawing", "number", "numbers", "prose", "symbols"), str)
    with pytest.raises(UndefinedError):
        environment(**ignored).get_template(name).render()


@pytest.mark.parametrize("name", SCRIPTS)
def test_scripts_and_styles_stand_in_a_page_as_they_are(name):
    page = environment().from_string("{{ asset(name) }}").render(name=name)
    assert page == asset(name) == (ROOT / name).read_text(encoding="utf-8")
    assert "</script" not in page and "</style" not in page


def test_licences_stay_in_their_comment():
    assert "--" not in licences() and "Three.js Authors" in licences()


def test_script_json():
    data = {"a": [1.5, ODD, "<!--", "é"]}
    assert "<" not in script_json(data) and "é" in script_json(data)
    assert json.loads(script_json(data)) == data
