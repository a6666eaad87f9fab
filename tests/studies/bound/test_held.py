"""Which bounds of a request hold a gait."""

from dataclasses import replace

import pytest

from spear_pin.gaits.library import REQUESTS
from spear_pin.studies.bound import list_active_bounds
from tests.gaits.bounding_gaits import gait

NAME = "long_stride"


@pytest.fixture(scope="module")
def asked():
    """The request of the gait, with bounds that are far from it."""
    return replace(REQUESTS[NAME], minimum_stance=0.001, minimum_knee_torque=0.0, friction=0.8)


@pytest.mark.parametrize(
    ("tight", "friction", "said"),
    [
        ({}, 0.5, ()),
        ({}, 0.79, ("friction is used up",)),
        ({"minimum_stance": "anterior_stance"}, 0.5, "the anterior stance is as short as it may be"),
        ({"minimum_knee_torque": "posterior_knee_torque"}, 0.5, "the posterior knee's torque at rest is the least"),
    ],
)
def test_said(asked, tight, friction, said):
    own = gait(NAME)
    values = {**own.durations, **vars(own.system.law)}
    found = list_active_bounds(own, replace(asked, **{name: values[value] for name, value in tight.items()}), friction)
    assert found == said if isinstance(said, tuple) else any(each.startswith(said) for each in found)


def test_a_flight_that_is_as_short_as_it_may_be(asked):
    own = gait(NAME)
    short = replace(own, durations=own.durations | {"flight_2": 0.0201})
    assert list_active_bounds(short, asked, 0.5) == ("flight 2 is as short as it may be",)
