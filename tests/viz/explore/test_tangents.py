"""Derivatives that the server of `spear explore` answers, and what its page makes of them."""

import json
import math
import re
from urllib.parse import urlencode

import pytest

from spear_pin.cli.explored import write_script
from spear_pin.studies.explore.engines import REFERENCE
from spear_pin.studies.explore.legs import KNOBS, spear_ii_hop
from spear_pin.studies.explore.tangents import LONE, MULTIPLIER, Tangents
from spear_pin.viz.chromium import find
from spear_pin.viz.explore.page import EFFECTS, slopes
from spear_pin.viz.explore.server import Explorer
from tests.viz.explore.exploring import ask, move, serving, text, visit

SHARE = 1e-3  # of a range, that a slider is moved either way
UNSAMPLED = ("apex_height", "flight_time", "stance_time")
EFFECT = re.compile(r"([+−])([\d.]+) (µ|m)?m per N·m/rad, ([+−])([\d.]+) %/%")


def asked(server, path, **numbers):
    """What the server answers."""
    status, _, body = ask(server, f"{path}?{urlencode(numbers)}")
    assert status == 200
    return json.loads(body)


def shown(server, **numbers):
    """Figures that are at events, and the largest multiplier's modulus."""
    said = asked(server, "/hop", **numbers)
    assert said["verdict"] == "periodic"
    return {name: said["figures"][name] for name in UNSAMPLED} | {MULTIPLIER: math.hypot(*said["multipliers"][0])}


@pytest.mark.extra("heyoka")
class TestAnswers:
    @pytest.mark.parametrize("name", ["stiffness", "knee_ratio"])
    @pytest.mark.parametrize("keep", ["no", "yes"])
    def test_slopes_are_differences_of_its_own_answers(self, server, keep, name):
        numbers = {"stiffness": 52.0, "knee_ratio": 14.0, "keep": keep}
        h = SHARE * (KNOBS[name].high - KNOBS[name].low)
        a, b, c, d = (shown(server, **{**numbers, name: numbers[name] + k * h}) for k in (1, -1, 2, -2))
        found = asked(server, "/tangents", **numbers)["slopes"][name]
        found |= asked(server, "/tangents/multiplier", **numbers)["slopes"][name]
        for figure, value in shown(server, **numbers).items():
            expected = (8 * (a[figure] - b[figure]) - (c[figure] - d[figure])) / (12 * h)  # of fourth order
            assert found[figure] * h == pytest.approx(expected * h, rel=1e-4, abs=1e-8 * value), figure

    def test_every_figure_of_the_list_has_one(self, server):
        found = (
            asked(server, "/tangents")["slopes"]["stiffness"]
            | asked(server, "/tangents/multiplier")["slopes"]["stiffness"]
        )
        assert set(found) == set(EFFECTS["hop"])

    def test_it_says_why_there_is_none(self, server):
        for numbers, why in (({"view": "transient"}, LONE), ({"knee_ratio": 22}, "toes alternate")):
            for path in ("/tangents", "/tangents/multiplier"):
                said = asked(server, path, **numbers)
                assert said["slopes"] == {} and said["reason"].endswith(why)

    def test_it_refuses_what_other_questions_do(self, server):
        assert ask(server, "/tangents?stiffness=1e6")[0] == 400
        assert ask(server, "/tangents?of=all")[0] == 400
        assert ask(server, "/tangents", Origin="http://evil.example")[0] == 403
        assert ask(server, "/tangents/multiplier", hosts=["evil.example"])[0] == 403


def test_what_is_not_a_number_is_null():
    said = slopes(Tangents({"stiffness": {MULTIPLIER: math.nan, "apex_height": 1.0}}))
    assert json.loads(json.dumps(said, allow_nan=False))["slopes"] == {
        "stiffness": {MULTIPLIER: None, "apex_height": 1.0}
    }


@pytest.mark.browser
@pytest.mark.slow
@pytest.mark.skipif(find() is None, reason="no Chromium here")
class TestPage:
    @pytest.mark.extra("heyoka")
    def test_each_slider_says_what_it_does(self, browser, server):
        browser.errors.clear()
        visit(browser, server, "#t=0.15")
        move(browser, "stiffness", 52)
        browser.run("explorer.tangents.arrived()")
        said = asked(server, "/tangents", stiffness=52)["slopes"]["stiffness"]["apex_height"]
        apex = asked(server, "/hop", stiffness=52)["figures"]["apex_height"]
        sign, size, prefix, other, share = EFFECT.fullmatch(text(browser, "effect_stiffness")).groups()
        scale = {"µ": 1e-6, "m": 1e-3, None: 1.0}[prefix]
        assert sign == other == "−" and -float(size) * scale == pytest.approx(said, rel=6e-3)
        assert -float(share) == pytest.approx(said * 52 / apex, rel=6e-2)
        assert all(text(browser, f"effect_{name}") for name in KNOBS)
        assert browser.errors == []

    @pytest.mark.extra("heyoka")
    def test_the_tangent_goes_through_the_present_place_of_the_slider_that_was_moved(self, browser, server):
        visit(browser, server, "#t=0.15")
        move(browser, "damping", 1.25)
        move(browser, "damping", 1.3)
        browser.run("explorer.tangents.arrived()")
        label = "document.querySelector('#tangent .u-over').getAttribute('aria-label')"
        assert (
            browser.run(label)
            == "Apex of the hip (m) over Knee damping (N·m·s/rad), with the tangent at the present place"
        )
        places, tangent, before, _, here = browser.run("explorer.tangents.drawn()")
        slope = asked(server, "/tangents", damping=1.3)["slopes"]["damping"]["apex_height"]
        (x0, y0), (x1, y1) = [(x, y) for x, y in zip(places, tangent, strict=True) if y is not None]
        (x, y) = next((x, y) for x, y in zip(places, here, strict=True) if y is not None)
        assert x == 1.3 and x0 < x < x1
        assert (y1 - y0) / (x1 - x0) == pytest.approx(slope) and y0 + slope * (x - x0) == pytest.approx(y)
        others = {x: y for x, y in zip(places, before, strict=True) if y is not None}
        assert others[1.25] == pytest.approx(y0 + slope * (1.25 - x0), abs=0.05 * abs(slope) * 0.05)
        browser.run("document.getElementById('number_stiffness').focus()")
        assert "Spring stiffness" in browser.run(label)

    @pytest.mark.extra("heyoka")
    def test_the_multiplier_is_asked_for_where_it_is_chosen(self, browser, server):
        visit(browser, server, "#t=0.15")
        browser.requests.clear()
        browser.run(f"""(async () => {{
            const choice = document.getElementById("effect");
            choice.value = "{MULTIPLIER}";
            choice.dispatchEvent(new Event("change"));
            await explorer.tangents.arrived();
        }})()""")
        slope = asked(server, "/tangents/multiplier")["slopes"]["damping"][MULTIPLIER]
        assert text(browser, "effect_damping").startswith(f"+{slope:.3g} per N·m·s/rad")
        assert any(address.endswith("/tangents/multiplier") for address in browser.requests)

    @pytest.mark.extra("heyoka")
    def test_where_there_is_none_it_says_why(self, browser, server):
        visit(browser, server, "?knee_ratio=22#t=0.15")
        browser.run("explorer.tangents.arrived()")
        assert text(browser, "said_of_effect").endswith("toes alternate.")
        assert text(browser, "effect_damping") == "no derivative"
        assert "toes alternate" in browser.run("document.getElementById('effect_damping').title")
        visit(browser, server, "?keep=yes&stiffness=52#t=0.15")
        browser.run("explorer.tangents.arrived()")
        assert text(browser, "effect_stance_torque") == "no derivative"
        assert "solved for" in browser.run("document.getElementById('effect_stance_torque').title")
        move(browser, "stiffness", 20)
        assert text(browser, "effect_damping") == "no derivative"

    def test_without_the_extra_there_is_nothing_of_it(self, browser):
        with serving(Explorer(spear_ii_hop(), REFERENCE, write_script)) as server:
            browser.errors.clear()
            browser.requests.clear()
            visit(browser, server, "#t=0.15")
            assert browser.run("explorer.tangents.arrived()") is None
            assert browser.run("document.getElementById('effects').hidden") is True
            assert browser.run("document.getElementById('tangent')") is None
            assert text(browser, "effect_stiffness") == "" and browser.errors == []
            assert not any("/tangents" in address for address in browser.requests)
