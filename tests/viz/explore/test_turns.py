"""Whose question is computed next, and which are not computed at all."""

import threading
import time

import pytest

from spear_pin.viz.explore.turns import Overloaded, Superseded, Turns


class Asked:
    """Questions that wait for a turn while another one has it, in the order in which they are asked."""

    def __init__(self, turns):
        self.turns, self.said, self.computed, self.threads = turns, {}, [], []

    def ask(self, name, client):
        before = len(self.said) + len(self.turns._waiting)
        thread = threading.Thread(target=self._ask, args=(name, client))
        thread.start()
        self.threads.append(thread)
        deadline = time.monotonic() + 10
        while len(self.said) + len(self.turns._waiting) == before:
            assert time.monotonic() < deadline
            time.sleep(1e-4)

    def _ask(self, name, client):
        try:
            with self.turns.turn(client):
                self.computed.append(name)
                self.said[name] = "computed"
        except (Superseded, Overloaded) as refused:
            self.said[name] = type(refused).__name__

    def end(self):
        for thread in self.threads:
            thread.join(10)


def test_the_newest_come_first_and_the_oldest_are_refused_at_once():
    asked = Asked(Turns(waiting=3))
    with asked.turns.turn("present"):
        for n in range(7):
            asked.ask(n, f"client {n}")
        asked.threads[3].join(10)  # none of those that are refused waits for the present one
        assert asked.said == dict.fromkeys(range(4), "Overloaded")
    asked.end()
    assert asked.computed == [6, 5, 4]


def test_a_newer_question_of_a_client_takes_its_place_and_no_other_ones():
    asked = Asked(Turns(waiting=2))
    with asked.turns.turn("present"):
        for name, client in (("a", "one"), ("b", "two"), ("c", "one"), ("d", "one")):
            asked.ask(name, client)
        asked.threads[2].join(10)
        assert asked.said == {"a": "Superseded", "c": "Superseded"}
    asked.end()
    assert asked.computed == ["d", "b"]


def test_a_question_waits_no_longer_than_its_client_has_patience():
    turns = Turns(patience=0.02)
    with turns.turn("present"), pytest.raises(Overloaded), turns.turn("other"):
        pass
    with turns.turn("other"):  # and nothing of it is left
        assert not turns._waiting and not turns._refused


def test_at_the_end_those_that_wait_are_refused():
    asked = Asked(Turns())
    with asked.turns.turn("present"):
        asked.ask("a", "one")
        ending = threading.Thread(target=asked.turns.end)
        ending.start()
        asked.end()
        assert asked.said == {"a": "Overloaded"} and ending.is_alive()
    ending.join(10)
    with pytest.raises(Overloaded), asked.turns.turn("two"):
        pass
