"""Each public name has an example in its docstring, and what the example prints is so."""

import doctest

import pytest

import spear_pin

FLAGS = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE
EXTRAS = dict.fromkeys(
    (
        "simulate_many",
        "find_many",
        "Sensitivity",
        "optimize_design",
        "Design",
        "Uncertainty",
        "continue_gait",
        "Branch",
    ),
    "heyoka",
)


SLOW = {"compare", "identify_motion", "replay"}


def named(name):
    if name in SLOW:
        return pytest.param(name, marks=pytest.mark.slow)
    return pytest.param(name, marks=pytest.mark.extra(EXTRAS[name])) if name in EXTRAS else name


@pytest.mark.parametrize("name", [named(name) for name in spear_pin.__all__])
def test_the_example_of(name):
    thing = getattr(spear_pin, name)
    (test,) = doctest.DocTestFinder(recurse=False).find(thing, name, module=False)
    assert test.examples, f"{name} has no example"
    text = []
    assert doctest.DocTestRunner(optionflags=FLAGS).run(test, out=text.append).failed == 0, "".join(text)
