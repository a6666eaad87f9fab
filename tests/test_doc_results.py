"""Pages of results: what makes their tables, when they were made, and how they are made again."""

import re
from pathlib import Path

import pytest

from docs import results

PAGES = sorted(results.PAGES.glob("*.md"))
MADE = "*Computed on 2026-01-02, 2 cores of x.*"
PLACE = "<!-- made by: python -m benchmarks.turns -->\n\nold\n\n<!-- end -->\n"
TABLES = "found:\n| a | b |\n| --- | --- |\n| 1 | 2 |\nbetween\n\n| c |\n|---|\n| 3 |\n"


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_a_page_says_when_it_was_made_and_by_what(page):
    text = page.read_text(encoding="utf-8")
    assert results.STAMP.search(text)
    assert re.search(r"^(OMP_NUM_THREADS=1 )?(python|spear) ", text, re.MULTILINE) or "`python " in text
    places = list(results.PLACE.finditer(text))
    assert len(places) == text.count("<!-- made by") == text.count("<!-- end -->")
    for place in places:
        assert results.TABLE.search(place["made"]) and results.STAMP.search(place["made"])


@pytest.mark.parametrize("command", results.commands())
def test_a_command_is_of_this_checkout(command):
    python, m, module, *_ = command.split()
    assert (python, m) == ("python", "-m")
    assert (results.PAGES.parents[1] / Path(*module.split("."))).with_suffix(".py").exists()


def test_tables_go_to_their_places_in_their_order():
    text = f"before\n{PLACE}between\n{PLACE.replace('turns', 'space')}{PLACE}after\n"
    put = results.put(text, "python -m benchmarks.turns", iter(results.TABLE.findall(TABLES)), MADE)
    assert [results.TABLE.findall(place["made"]) for place in results.PLACE.finditer(put)] == [
        ["| a | b |\n| --- | --- |\n| 1 | 2 |\n"],
        [],
        ["| c |\n|---|\n| 3 |\n"],
    ]
    assert put.count(MADE) == 2 and put.startswith("before\n") and put.endswith("after\n")
    assert results.put(put, "python -m benchmarks.turns", iter(results.TABLE.findall(TABLES)), MADE) == put


def test_too_few_tables_change_nothing():
    with pytest.raises(SystemExit, match="prints fewer tables"):
        results.put(PLACE + PLACE, "python -m benchmarks.turns", iter(["| a |\n|---|\n| 1 |\n"]), MADE)


def test_the_line_below_a_table():
    assert results.STAMP.fullmatch(results.stamp())
