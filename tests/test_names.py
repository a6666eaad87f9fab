"""One name, one number: summaries, samples, lanes and derivatives of gaits, and of some all that commands say."""

import numpy as np
import pytest

from spear_pin import Gait, find_gait, hopping, load, simulate
from spear_pin.errors import UnknownName
from spear_pin.gaits.measures.catalogue import describe_measure
from spear_pin.gaits.measures.of_samples import Sampled
from spear_pin.gaits.sensitivity.many_measures import measure_lanes
from spear_pin.gaits.sensitivity.orbit import Orbit
from spear_pin.hybrid.parameters import number
from spear_pin.studies.bound import summarize as summarize_bound
from spear_pin.studies.hop import summarize as summarize_hop
from tests.names.comparison import Table
from tests.names.said import called, first_number, numbers
from tests.names.subjects import SUBJECTS

SUMMARIES = {"hopping": summarize_hop, "bounding": summarize_bound}


def solved_hop():
    return find_gait(hopping(load("spear_ii", locked=["boom_x"])), ["stance_torque"], {"flight_time": 0.2})


def of_samples(gait):
    """What a summary and samples say, of few and of more samples."""
    table, run = Table(), simulate(gait.system, gait.state, 2, progress=False)
    table.add("summary", dict(numbers(SUMMARIES[gait.system.kind](gait, run))))
    table.add("samples", Sampled(gait.system.robot, run).values())
    table.add("two cycles", Sampled(gait.system.robot, run, (1, 2)).values())
    return table


@pytest.mark.parametrize("name", ["hop", "long_stride"])
def test_summaries_and_samples(name):
    table = of_samples(solved_hop() if name == "hop" else Gait.load(name))
    assert not table.apart
    assert {"effort", "peak_speed_knee" if name == "hop" else "cost_of_transport"} <= set(table.shared)


@pytest.mark.slow
@pytest.mark.extra("heyoka")
@pytest.mark.parametrize("name", ["hop", "long_stride", "force_lift_off"])
def test_derivatives_and_lanes(name):
    gait = solved_hop() if name == "hop" else Gait.load(name)
    table = of_samples(gait)
    found = {each: measure for each, measure in Orbit(gait.system, gait.state, ()).measures.items()}
    table.add("derivatives", {each: measure.value for each, measure in found.items()})
    assert {each: describe_measure(each).unit for each in found} == {
        each: measure.unit for each, measure in found.items()
    }
    given = {"friction": np.array([number(gait.system, "friction")])}
    lanes, _ = measure_lanes(gait.system, given, gait.state[0][None], gait.state[1][None])
    table.add("lanes", {each: float(values[0]) for each, values in lanes.items()})
    assert not table.apart and len(table.shared) > 20


@pytest.mark.slow
@pytest.mark.extra("heyoka")
@pytest.mark.extra("joblib", "xarray", "zarr")
@pytest.mark.parametrize("name", SUBJECTS)
def test_what_all_say(name, tmp_path):
    table = Table()
    SUBJECTS[name](table, tmp_path)
    assert not table.apart and len(table.shared) > 10


class TestTable:
    def test_two_numbers_under_one_name(self):
        table = Table()
        table.add("one", {"cost": 0.554, "work": 2.0})
        table.add("another", {"cost": 0.3265, "work": 2.0 + 1e-7})
        assert (table.shared, table.apart) == (["cost", "work"], ["cost"])

    def test_what_is_rounded_in_print(self):
        table = Table()
        table.add("one", {"cost": 0.5538})
        table.rounded("print", "cost", *first_number("0.554 (absolute work)"))
        assert not table.apart
        table.rounded("print", "cost", *first_number("0.552"))
        assert table.apart == ["cost"]

    def test_labels(self):
        assert called("peak normal force, posterior toe, a pair") == "peak_force_posterior_toe"
        assert called("peak torque, posterior hip, one motor") == "peak_torque_posterior_hip"
        assert first_number("−4.50°") == pytest.approx((np.radians(-4.5), np.radians(0.005)))

    def test_lists_of_names_end(self):
        with pytest.raises(UnknownName):
            describe_measure("anything")
