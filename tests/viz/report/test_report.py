"""The report: parts of it made, rendered, and opened in a browser."""

import json
import re
import time
from dataclasses import replace

import pytest
from lxml import etree
from matplotlib.figure import Figure

from spear_pin.errors import BadValue, UnknownName
from spear_pin.studies.audit.statements import ASSUMPTIONS, STATEMENTS, VERDICTS, Case, Finding
from spear_pin.studies.audit.statements.criteria import Criterion
from spear_pin.studies.audit.statements.tables import TABULATIONS
from spear_pin.viz.embedding import shared
from spear_pin.viz.report import Report, Selection, make, select, write_figures
from spear_pin.viz.report.cache import Cache
from spear_pin.viz.report.page import MOST_BYTES, render
from spear_pin.viz.report.pictures import NOTHING_TO_COMPUTE, PICTURES
from spear_pin.viz.report.playbacks import PLAYBACKS
from spear_pin.viz.report.text import blocks, number, numbers, prose, symbols
from tests.viz import chromium
from tests.viz.samples import ODD

QUICK = ["fig-2.1", "fig-2.4", "fig-3.2", "table-3.1", "flight-law-sign", "motor-length", "play-release"]
ALL = [picture for chapter in PICTURES.values() for picture in chapter]


@pytest.fixture(scope="module")
def report():
    return make(select(QUICK))


@pytest.fixture(scope="module")
def page(report):
    return render(report)


@pytest.fixture(scope="module")
def tree(page):
    return etree.HTML(page)


class TestSelection:
    def test_all(self):
        everything = select()
        assert everything.statements == STATEMENTS and everything.playbacks == PLAYBACKS
        assert len(everything) == len(STATEMENTS) + len(ALL) + 4 + len(PLAYBACKS)

    def test_a_figure_brings_its_statements(self):
        chosen = select(["fig-4.6"])
        assert [picture.id for picture in chosen.pictures] == ["fig-4.6"] and not chosen.playbacks
        assert {statement.exhibit for statement in chosen.statements} == {"fig-4.6"}

    def test_what_is_not_there(self):
        with pytest.raises(UnknownName, match="fig-9"):
            select(["fig-2.1", "fig-9*"])

    def test_every_figure_and_table_shows_a_statement_and_so_has_a_verdict(self):
        shown = {picture.id for picture in ALL} | {each.id for tables in TABULATIONS.values() for each in tables}
        assert {statement.exhibit for statement in STATEMENTS} - {""} == shown

    @pytest.mark.parametrize("number", [*range(1, 14)])
    def test_figures_of_chapter_4_are_all_there(self, number):
        assert self._answered(4, number)

    @pytest.mark.parametrize("number", [*range(1, 9)])
    def test_figures_of_chapter_5_are_all_there(self, number):
        assert self._answered(5, number)

    @pytest.mark.parametrize("number", [*range(1, 13)])
    def test_figures_of_chapter_2_are_all_there(self, number):
        assert self._answered(2, number)

    @staticmethod
    def _answered(chapter, number):
        places = " ".join([*(picture.place for picture in ALL), *NOTHING_TO_COMPUTE])
        return re.search(rf"\b{chapter}\.{number}\b", places)


class TestMaking:
    @pytest.mark.slow
    def test_each_part_is_made(self, report):
        assert report.failures == {}
        assert set(report.pictures) == {"fig-2.1", "fig-2.4", "fig-3.2"} and set(report.rows) == {"table-3.1"}
        assert set(report.pages) == {"play-release"}
        assert report.counts["differs"] >= 4 and sum(report.counts.values()) == len(report.findings)

    def test_what_was_kept_is_not_made_again(self, tmp_path, monkeypatch):
        cache, chosen = Cache(tmp_path, "state"), select(["fig-2.1", "table-3.1"])
        first = make(chosen, cache)
        monkeypatch.setattr("spear_pin.viz.report.making.check", lambda statement: pytest.fail("checked again"))
        monkeypatch.setattr("spear_pin.viz.report.making.save_figure", lambda *given: pytest.fail("drawn again"))
        again = make(chosen, cache)
        assert again.findings == first.findings and again.pictures == first.pictures

    def test_what_fails_is_part_of_the_report(self, tmp_path):
        def broken() -> Figure:
            raise BadValue("this", 0, "something else")

        statement = replace(STATEMENTS[0], exhibit="fig-2.1", study=broken)
        picture = replace(ALL[0], draw=broken)
        cache = Cache(tmp_path, "state")
        report = make(Selection((statement,), (picture,), (), ()), cache)
        assert report.counts["failed"] == 1 and "something else" in report.failures[picture.id]
        assert list(tmp_path.iterdir()) == [], "a failure is not kept"

    def test_a_picture_that_fails_says_so(self):
        picture = PICTURES[2][0]
        report = Report(Selection((), (picture,), (), ()), failures={picture.id: f"BadValue: {ODD} is 0"})
        (reason,) = etree.HTML(render(report)).xpath("//p[@class='reason']")
        assert "".join(reason.itertext()) == f"!failed BadValue: {ODD} is 0"

    def test_odd_words_are_shown_as_they_are(self, report):
        """In every place that a report takes words from elsewhere."""
        statement = replace(
            next(each for each in STATEMENTS if each.id == "flight-law-sign"),
            place=ODD, says=ODD, finds=ODD, unit=ODD, remark=ODD, criterion=Criterion(ODD, bool),
        )  # fmt: skip
        table = replace(TABULATIONS[3][0], place=ODD, caption=ODD, head=(ODD,))
        playback = replace(PLAYBACKS[0], caption=ODD)
        picture = replace(PICTURES[2][0], place=ODD, caption=ODD, shows=ODD)
        finding = Finding(statement.id, (1.0, 2.0), "failed", ODD, (Case(ODD, 1.0, True),))
        odd = Report(
            Selection((statement,), (picture,), (table,), (playback,)),
            {statement.id: finding},
            {picture.id: report.pictures[picture.id]},
            {table.id: [(ODD,)]},
            {playback.id: f"<title>{ODD}</title><script>{ODD}</script>"},
        )
        with pytest.MonkeyPatch.context() as patch:
            patch.setitem(PICTURES, 2, (picture,))
            patch.setitem(TABULATIONS, 3, (table,))
            tree = etree.HTML(render(odd))
        assert not tree.xpath("//b[text()='x']") and len(tree.xpath("//script")) == 2
        shown = "".join(tree.xpath("//body//text()[not(ancestor::script)]"))
        # statement, picture, table, playback; of these picture and table stand in the contents, too
        assert shown.count(ODD) == 9 + 3 + 4 + 1 + 2
        assert tree.xpath("//svg/@aria-label") == [f"{ODD}: {ODD}"]

    def test_figures_in_other_formats(self, tmp_path):
        report = make(select(["fig-2.1"]), formats=("svg", "pdf", "png"))
        heads = {"svg": b"<?xml", "pdf": b"%PDF", "png": b"\x89PNG"}
        for suffix, head in heads.items():
            (path,) = write_figures(report, tmp_path / "figures", suffix)
            assert path.name == f"fig-2.1.{suffix}" and path.read_bytes().startswith(head)


class TestPage:
    def test_it_is_whole_and_small(self, page):
        assert "{{" not in page and len(page.encode()) <= MOST_BYTES

    def test_it_asks_for_nothing(self, tree):
        named = [value for element in tree.iter() for name, value in element.attrib.items()
                 if name.rpartition("}")[2] in ("src", "href", "data", "action", "srcset")]  # fmt: skip
        assert named and all(value.startswith(("#", "data:")) for value in named)
        assert "url(http" not in "".join(tree.xpath("//style/text()"))

    def test_ids_are_unique_and_links_lead_somewhere(self, tree):
        ids = tree.xpath("//@id")
        assert len(ids) == len(set(ids))
        assert {link[1:] for link in tree.xpath("//a/@href")} <= set(ids)

    def test_every_statement_is_there_once_with_its_verdict_in_words(self, tree, report):
        rows = tree.xpath("//tr[@data-verdict]")
        assert sorted(row.get("id") for row in rows) == sorted(report.findings)
        for row in rows:
            assert report.findings[row.get("id")].verdict in "".join(
                row.xpath(".//span[contains(@class, 'badge')]//text()")
            )

    def test_the_numbers_are_those_found(self, tree, report):
        (row,) = tree.xpath("//tr[@id='kinetic-energy']")
        assert "".join(row.xpath(".//p[@class='value']//text()")) == "0.1636; 0.1932 kg·m²"
        assert "kinetic-energy" in report.findings

    def test_alternatives_stand_in_their_row(self, tree, report):
        (row,) = tree.xpath("//tr[@id='flight-law-sign']")
        shown = ["".join(each.itertext()) for each in row.xpath(".//p[@class='case']")]
        assert len(shown) == 2 and shown[0].startswith("knee commanded to 0.9 rad: 35.")

    def test_verdicts_have_their_rules_and_assumptions_their_consequences(self, tree):
        rules = tree.xpath("//section[@id='method']//span[contains(@class, 'badge')]/text()")
        assert rules == [verdict for verdict in VERDICTS if verdict != "failed"]
        rows = tree.xpath("//section[@id='assumptions']//tr")
        assert len(rows) == len(ASSUMPTIONS) and all(row.xpath(".//p[@class='remark']") for row in rows)

    def test_errata_have_their_tables(self, tree):
        tables = tree.xpath("//section[@id='errata']//div[@class='wide']/table")
        assert tables
        for table in tables:
            head, *rows = ([cell.tag for cell in row] for row in table.iter("tr"))
            assert set(head) == {"th"} and rows == [["td"] * len(head)] * len(rows)

    def test_the_head_counts(self, tree, report):
        shown = [int(word) for word in tree.xpath("//ul[@class='tiles']//strong/text()")]
        assert shown == [count for verdict, count in report.counts.items() if verdict != "failed"]

    def test_the_viewer_stands_in_it_once(self, page, tree):
        data = json.loads(tree.xpath("//script[@id='data']/text()")[0])
        assert len(data["viewer"]) > 500_000 and set(data["pages"]) == {"play-release"}
        assert all(data["viewer"] not in side for side in data["pages"]["play-release"])

    def test_what_the_graphics_are_called_is_said(self, tree):
        labels = tree.xpath("//svg/@aria-label")
        assert len(labels) == 3 and all(label.startswith("Fig.") for label in labels)

    def test_a_part_without_playbacks(self):
        page = render(Report(Selection((), (), (), ())))
        assert 'id="playbacks"' not in page and "0</strong> statements" in page


class TestPlaybacks:
    def test_shared(self):
        pages = [f"<head>{name}<script>the viewer</script><script>{name}</script>" for name in "ab"]
        viewer, ((before, after), _) = shared(pages)
        assert viewer == "the viewer" and before + viewer + after == pages[0]

    def test_nothing_to_share(self):
        assert shared([]) == ("", [])

    @pytest.mark.parametrize("pages", [["no script"], ["<script>a</script>", "<script>b</script>"]])
    def test_no_viewer_in_common(self, pages):
        with pytest.raises(BadValue):
            shared(pages)


class TestText:
    @pytest.mark.parametrize(
        ("value", "shown"),
        [
            (0.0, "0"), (1.0, "1"), (-0.5, "−0.5"), (51.35333, "51.35"), (0.19322, "0.1932"), (2999.75, "3000"),
            (1.2e-16, "1.20·10<sup>−16</sup>"), (43.76, "43.76"), (100.0, "100"), (0.00012, "0.00012"),
            (1e7, "1.00·10<sup>7</sup>"),
        ],
    )  # fmt: skip
    def test_number(self, value, shown):
        assert number(value) == shown

    def test_numbers(self):
        assert numbers((1.0, 2.5), "N·m") == "1; 2.5 N·m" and numbers(3.0) == "3"

    @pytest.mark.parametrize(
        ("words", "shown"),
        [
            ("k_rot", "k<sub>rot</sub>"),
            ("r_Pulley²", "r<sub>Pulley</sub>²"),
            ("|ẋ_c|²", "|ẋ<sub>c</sub>|²"),
            ("ū_p < 0", "ū<sub>p</sub> &lt; 0"),
            ("L²_f h", "L²<sub>f</sub> h"),
            ("long_stride", "long_stride"),
            ("u^sw", "u<sup>sw</sup>"),
        ],
    )
    def test_indices(self, words, shown):
        assert symbols(words) == shown

    def test_a_unit_is_escaped(self):
        assert numbers((1.0, 2.0), "<N>") == "1; 2 &lt;N&gt;"

    def test_prose(self):
        shown = prose("A `b_c` of [d](e.md) *not* f < g.")
        assert shown == "A <code>b<sub>c</sub></code> of d <em>not</em> f &lt; g."

    def test_blocks(self):
        assert blocks("a\n\n| g | h |\n| --- | --- |\n| 1 | <2> |") == ["a", [["g", "h"], ["1", "<2>"]]]


@pytest.fixture(scope="module")
def opened(page, tmp_path_factory):
    path = tmp_path_factory.mktemp("a report") / "report.html"
    path.write_text(page, encoding="utf-8")
    with chromium.Browser() as browser:
        browser.send("Page.navigate", page=True, url=path.as_uri())
        wait(browser, "document.readyState === 'complete' && document.querySelector('.filter')")
        yield browser


def wait(browser, condition):
    deadline = time.monotonic() + 60
    while not browser.run(f"Boolean({condition})"):
        assert time.monotonic() < deadline, (condition, browser.errors)
        time.sleep(0.1)


@pytest.mark.browser
@pytest.mark.skipif(chromium.find() is None, reason="no Chromium here")
class TestBrowser:
    def test_filter(self, opened, report):
        shown = "[...document.querySelectorAll('tr[data-verdict]')].filter(row => row.offsetParent).length"
        opened.run("document.querySelector('.filter [value=differs]').click()")
        assert opened.run(shown) == report.counts["differs"]
        opened.run("document.querySelector('.filter [value=built]').click()")
        assert opened.run(shown) == report.counts["by construction"] == 2
        opened.run("document.querySelector('.filter [value=\"\"]').click()")
        assert opened.run(shown) == len(report.findings)

    @pytest.mark.parametrize("width", [400, 1280])
    def test_it_fits_its_window(self, opened, width):
        size = {"height": 800, "deviceScaleFactor": 1, "mobile": False}
        opened.send("Emulation.setDeviceMetricsOverride", page=True, width=width, **size)
        assert opened.run("document.documentElement.scrollWidth") <= width

    @pytest.mark.slow
    def test_playback(self, opened):
        opened.run("document.querySelector('#play-release button').click()")
        frame = "document.querySelector('#play-release iframe').contentWindow"
        wait(opened, f"{frame}.player && {frame}.player.time > 0")
        opened.run(f"{frame}.player.seek(0.6)")
        assert opened.run(f"{frame}.document.getElementById('domain').textContent") == "pinned"

    def test_no_error_and_no_request(self, opened):
        assert opened.errors == []
        assert opened.requests and all(
            address.split(":")[0] in ("file", "data", "blob", "about") for address in opened.requests
        )
        assert sum(address.startswith("file:") for address in opened.requests) == 1
