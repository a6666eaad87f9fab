"""`spear measures`."""

import json

from spear_pin.cli.measures import PLACES
from spear_pin.gaits.measures.catalogue import CATALOGUE
from tests.cli.calls import ROOT, run


def test_lists_every_measure(capsys):
    status, out, _ = run(capsys, "measures")
    assert status == 0 and all(each.pattern in out for each in CATALOGUE)
    assert max(map(len, out.splitlines())) <= 116 and "Words in capitals" in out
    assert "margin_EVENT" in out


def test_the_manual_says_the_same_of_names_and_units():
    manual = (ROOT / "docs" / "reference" / "measures.md").read_text(encoding="utf-8")
    stand, slide = PLACES.splitlines()
    assert stand.partition(".")[0] in manual and slide in manual


def test_as_json(capsys):
    rows = json.loads(run(capsys, "measures", "--json")[1])["measures"]
    assert [row["name"] for row in rows] == [each.pattern for each in CATALOGUE]
    assert {"unit": "1", "name": "cost_of_transport", "target": True}.items() <= next(
        row for row in rows if row["name"] == "cost_of_transport"
    ).items()
