"""The store of a payoff study: lines that are whole, and the file of just this study."""

import pandas
import pytest

from spear_pin.errors import BadFile
from spear_pin.studies.payoff.store import Store

ASKED = {"robot": "a", "speeds": [1.0, 2.0]}


@pytest.fixture
def path(tmp_path):
    store = Store(tmp_path / "store.jsonl", ASKED)
    for key in ("one", "two"):
        store.keep({"key": key, "cost": 0.1 + 0.2})
    return store.path


class TestStore:
    def test_a_study_that_is_refused_before_its_first_search_leaves_no_file(self, tmp_path):
        path = tmp_path / "store.jsonl"
        assert len(Store(path, ASKED)) == 0 and not path.exists()
        Store(path, ASKED | {"speeds": [1.0]}).keep({"key": "one"})
        assert len(Store(path, ASKED | {"speeds": [1.0]})) == 1

    def test_lines_are_read_again_to_the_bit(self, path):
        again = Store(path, ASKED)
        assert len(again) == 2 and again.get("two") == {"key": "two", "cost": 0.1 + 0.2} and again.get("three") is None

    def test_each_line_is_plain_json(self, path):
        read = pandas.read_json(path, lines=True)
        assert read["key"].tolist()[1:] == ["one", "two"] and read["cost"][2] == pytest.approx(0.3)
        assert read["checksum"].str.fullmatch("[0-9a-f]{16}").all()

    def test_a_line_without_its_checksum_is_refused(self, path):
        path.write_text(path.read_text(encoding="utf-8") + '{"key":"three"}\n', encoding="utf-8")
        with pytest.raises(BadFile, match=r"store.jsonl:4: is damaged"):
            Store(path, ASKED)

    def test_a_file_of_the_version_before_is_refused_by_its_name(self, tmp_path):
        path = tmp_path / "old.jsonl"
        path.write_text('0123456789abcdef {"format":"spear_pin payoff 1","robot":"a"}\n', encoding="utf-8")
        with pytest.raises(BadFile, match="earlier version; give another --out, or remove it"):
            Store(path, ASKED)

    @pytest.mark.parametrize("left", [1, 20, 41])
    def test_a_line_that_was_cut_off_is_dropped_and_written_again(self, path, left):
        whole = path.read_bytes()
        path.write_bytes(whole + whole.splitlines(keepends=True)[-1][:left])
        again = Store(path, ASKED)
        assert len(again) == 2 and path.read_bytes() == whole
        again.keep({"key": "three", "cost": 1.0})
        assert len(Store(path, ASKED)) == 3

    def test_damage_is_refused_at_its_line(self, path):
        path.write_bytes(path.read_bytes().replace(b"0.3000", b"0.4000", 1))
        with pytest.raises(BadFile, match=r"store.jsonl:2: is damaged"):
            Store(path, ASKED)

    def test_another_study_is_refused_and_what_differs_is_named(self, path):
        before = path.read_bytes()
        with pytest.raises(BadFile, match="another study, which differs in speeds"):
            Store(path, ASKED | {"speeds": [1.0]})
        assert path.read_bytes() == before

    @pytest.mark.parametrize("content", [b"", b"hello\n", b"\xff\xfe\n", b"{}\n"])
    def test_another_file_is_refused_and_left_alone(self, tmp_path, content):
        path = tmp_path / "other.jsonl"
        path.write_bytes(content)
        with pytest.raises(BadFile):
            Store(path, ASKED)
        assert path.read_bytes() == content
