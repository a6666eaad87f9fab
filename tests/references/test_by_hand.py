"""The files alone, as README.md describes them, give their answers."""

import pytest

from spear_pin.cli.references import SHIPPED
from spear_pin.references.check import compare, read
from tests.references.by_hand import Hand, runs
from tests.slow import slow_but

REFERENCES = {name: each for name, each in read(SHIPPED).items() if runs(each)}


@pytest.mark.parametrize("name", slow_but(REFERENCES, "block_slides", "leg_hops_late", "leg_climbs"))
def test_the_answer_is_that_of_another_program(name):
    differences, others = compare(REFERENCES[name], Hand(REFERENCES[name]).run())
    assert not others and differences[0].off <= differences[0].bound, str(differences[0])


def test_they_are_all_of_a_single_foot():
    assert len(REFERENCES) == 14
