"""Gaits and trajectories that many tests look at, solved once a process, and the rule for tests that skip."""

import gc
import os
from importlib.metadata import PackageNotFoundError, version
from importlib.util import find_spec
from pathlib import Path

import pytest

os.environ.setdefault("OMP_NUM_THREADS", "1")  # matrices are small, and processes as many as processors

from spear_pin import Gait, HoppingLaw, find_gait, hopping, load, simulate
from spear_pin.model.loading import ROBOTS
from tests.durations import Durations
from tests.nightly import left_to_the_nightly

HERE = Path(__file__).parent
SOLVED = HERE / "solved"


def pytest_addoption(parser):
    """What tests take is written, and compared with budgets."""
    parser.addoption("--durations-json", type=Path, help="write the processor time of each folder and file to FILE")
    parser.addoption("--budgets", help="fail where a folder takes longer than its budget of that name")


def pytest_configure(config):
    """Measures what tests take, in every run."""
    config.pluginmanager.register(
        Durations(config.getoption("--durations-json"), config.getoption("--budgets")), "spear-durations"
    )


@pytest.hookimpl(wrapper=True)
def pytest_collection():
    """What collection makes, ten thousand tests, stays to the end, so that nobody need look for garbage among it."""
    gc.disable()
    try:
        return (yield)
    finally:
        gc.enable()
        gc.freeze()


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(config, items):
    """A test skips where a module, or a package without one, that its marker `extra` names is missing.

    What `nightly.toml` names is marked `nightly`, and slow, too. The files of this folder itself, which take longest,
    come first, so that no worker is left with one of them at the end.
    """
    items.sort(key=lambda item: item.path.parent != HERE)
    left_to_the_nightly(items, whole=config.args_source is pytest.Config.ArgsSource.TESTPATHS)
    for item in items:
        needed = {module for marker in item.iter_markers("extra") for module in marker.args}
        if missing := sorted(module for module in needed if not _is_there(module)):
            item.add_marker(pytest.mark.skip(reason=f"needs {', '.join(missing)}"))


def _is_there(name):
    try:
        return find_spec(name) is not None or bool(version(name))
    except PackageNotFoundError:
        return False


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item):
    """Only what is marked `extra` runs again where the extras are: nothing else may skip, but for what is not here."""
    report = yield
    if report.skipped and not hasattr(report, "wasxfail") and not item.get_closest_marker("extra"):
        *_, reason = report.longrepr
        if not reason.endswith(" here"):
            report.outcome, report.longrepr = "failed", f"{reason}: skips without the marker `extra`"
    return report


@pytest.fixture(scope="module", autouse=True)
def soon_compiled(request):
    """Tests compile much and run little of it, so it is not optimised; in modules marked `optimised` it is.

    What few lanes meet is compiled, too, so that they test it.
    """
    from spear_pin.hybrid.engines import taylor
    from spear_pin.hybrid.lanes import runner

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(runner, "RARE", 0)
        if request.node.get_closest_marker("optimised") is None:
            patch.setattr(taylor, "LEVEL", 0)
        yield


def speed_at_lift_off(run):
    """Forward speed of the hip at lift-off, a measure of one cycle."""
    return run.event("lift_off").v_before[0]


@pytest.fixture(autouse=True)
def measures_of_ones_own():
    """Those that a test, or a block of the docs, registers are gone after it."""
    from spear_pin.gaits.measures.catalogue import CATALOGUE

    before = list(CATALOGUE)
    yield
    CATALOGUE[:] = before


@pytest.fixture(scope="session")
def robot():
    """SPEAR-II on its slider, unable to move forward."""
    return load("spear_ii", locked=["boom_x"])


@pytest.fixture(scope="session")
def free_robot():
    """SPEAR-II, free to move forward."""
    return load("spear_ii")


@pytest.fixture(scope="session")
def rubbing_robot(tmp_path_factory):
    """The same with 2.5 N·s/m of viscous friction on the slider, from <dynamics damping=...> of its URDF."""
    text = ROBOTS["spear_ii"].path.read_text(encoding="utf-8")
    position = text.index("</joint>", text.index('<joint name="boom_z"'))
    path = tmp_path_factory.mktemp("robots") / "rubbing.urdf"
    path.write_text(text[:position] + '<dynamics damping="2.5"/>' + text[position:], encoding="utf-8")
    return load(path, toes=["toe"], locked=["boom_x"])


@pytest.fixture(scope="session")
def hop(robot):
    """The hop in place with 0.2 s of flight."""
    return find_gait(hopping(robot), vary=["stance_torque"], target={"flight_time": 0.2})


@pytest.fixture(scope="session")
def hops(hop):
    """Eleven of these hops."""
    return simulate(hop.system, hop.state, cycles=11)


@pytest.fixture(scope="session")
def stabilised():
    """The long stride with event feedback, as it was found once: `tests/gaits/test_feedback.py` finds it again."""
    return Gait.load(SOLVED / "long_stride_regulated.json")


@pytest.fixture(scope="session")
def free_hop(free_robot):
    """The hop in place with 0.2 s of flight, boom_x free: the hip angle is what keeps it in place."""
    system = hopping(free_robot, HoppingLaw(hip_touchdown=0.5))
    target = {"flight_time": 0.2, speed_at_lift_off: 0.0}
    return find_gait(system, vary=["stance_torque", "hip_touchdown"], target=target)
