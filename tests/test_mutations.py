"""The mistakes made on purpose: each changes what is there, and names tests that there are."""

import pytest

from tests.mistakes import MUTATIONS
from tests.mutations import ROOT


@pytest.mark.parametrize("mutation", MUTATIONS, ids=lambda mutation: mutation.name)
def test_changes_one_place(mutation):
    assert (ROOT / mutation.file).read_text(encoding="utf-8").count(mutation.old) == 1
    assert mutation.new != mutation.old
    assert mutation.tests and all((ROOT / test).is_file() for test in mutation.tests)


def test_names_occur_once():
    assert len({mutation.name for mutation in MUTATIONS}) == len(MUTATIONS)
