"""What tells compiled functions apart, and a law edited between two calls."""

import sys
import types
from dataclasses import replace
from functools import partial

import numpy as np
import pytest

from spear_pin.hybrid.batch import simulate_many
from spear_pin.hybrid.engines.identity import Reader


def module(text, name="somewhere"):
    """A module of this source."""
    made = types.ModuleType(name)
    exec(text, vars(made))
    return made


def identity(value):
    return Reader().identity(value)


ALIKE = "SCALE = 2.0\ndef helper(x):\n    return x * SCALE\ndef law(x, gain=3.0):\n    return helper(x) + gain"
EDITS = {
    "a constant": ALIKE.replace("* SCALE", "* 5.0"),
    "a name": ALIKE.replace("helper(x) +", "helper(gain) +"),
    "a default": ALIKE.replace("gain=3.0", "gain=4.0"),
    "a global": ALIKE.replace("SCALE = 2.0", "SCALE = 2.5"),
    "what it calls": ALIKE.replace("x * SCALE", "x / SCALE"),
}


def test_the_same_source_is_the_same_function():
    assert identity(module(ALIKE).law) == identity(module(ALIKE).law)


@pytest.mark.parametrize("edit", EDITS)
def test_an_edit_makes_another(edit):
    assert identity(module(EDITS[edit]).law) != identity(module(ALIKE).law)


def test_what_is_closed_over():
    def law(gain):
        return lambda x: gain * x

    array = np.arange(3.0)
    for one, other in [(1.0, 2.0), (array, array + 1.0), ([1.0], [2.0]), ({"a": 1.0}, {"a": 2.0}), (len, abs)]:
        assert identity(law(one)) == identity(law(one)) != identity(law(other))
    mutable = [1.0]
    before = identity(law(mutable))
    mutable[0] = 2.0
    assert identity(law(mutable)) != before


def test_partial_and_bound_functions():
    def law(gain, x, offset=0.0):
        return gain * x + offset

    assert identity(partial(law, 1.0)) == identity(partial(law, 1.0)) != identity(partial(law, 2.0))
    assert identity(partial(law, 1.0, offset=1.0)) != identity(partial(law, 1.0))
    class_of = module("class Law:\n    def law(self, x):\n        return x").Law
    one, other = class_of(), class_of()
    assert identity(one.law) == identity(one.law) != identity(other.law)


def test_modules_are_looked_into():
    def law(place):
        return lambda x: place.law(x)

    assert identity(law(module(ALIKE))) != identity(law(module(EDITS["a default"])))
    place, reader = module(ALIKE), Reader()
    reader.identity(law(place))
    place.SCALE = 3.0
    assert not reader.current()


def test_recursion_ends():
    assert identity(module("def law(n):\n    return law(n - 1) if n else 0").law)


def test_what_is_no_container_equals_itself_only():
    class Strange:
        __hash__ = None

    one = Strange()
    assert identity(one) == identity(one) != identity(Strange())


@pytest.mark.parametrize("name, value", [("SCALE", 2.5), ("helper", abs)])
def test_what_is_bound_anew_is_seen(name, value):
    place, reader = module(ALIKE), Reader()
    reader.identity(place.law)
    assert reader.current()
    setattr(place, name, value)
    assert not reader.current()


def test_code_replaced_in_place_is_seen():
    """As a notebook that reloads what was edited does."""
    place, reader = module(ALIKE), Reader()
    reader.identity(place.law)
    place.helper.__code__ = module(EDITS["what it calls"]).helper.__code__
    assert not reader.current()


def _list():
    gains = [0.0]
    return (lambda: gains), lambda: gains.append(1.0)


def _array():
    gains = np.zeros(2)
    return (lambda: gains), lambda: gains.fill(1.0)


def _mapping():
    gains = {"hip": 0.0}
    return (lambda: gains), lambda: gains.update(hip=1.0)


def _cell():
    gain = 0.0

    def change():
        nonlocal gain
        gain = 1.0

    return (lambda: gain), change


def _attribute():
    made = module("class Law:\n    gain = 0.0\n    def law(self):\n        return self.gain").Law()
    return made.law, lambda: setattr(made, "gain", 1.0)


def _imported():
    gains = sys.modules["gains_of_a_test"] = module("GAIN = 0.0", "gains_of_a_test")
    text = "def law():\n    from gains_of_a_test import GAIN\n    return GAIN"
    return module(text).law, lambda: setattr(gains, "GAIN", 1.0)


def _bound_later():
    place = module("def law():\n    return LATER")
    return place.law, lambda: setattr(place, "LATER", 1.0)


@pytest.mark.parametrize("made", [_list, _array, _mapping, _cell, _attribute, _imported, _bound_later])
def test_what_is_changed_in_place_is_seen(made):
    law, change = made()
    reader = Reader()
    before = reader.identity(law)
    assert reader.current()
    change()
    assert not reader.current() and identity(law) != before


def test_the_order_of_a_mapping_counts():
    def law(gains):
        return lambda: list(gains.values())

    assert identity(law({"a": 1.0, "b": 2.0})) != identity(law({"b": 2.0, "a": 1.0}))


def test_a_global_called_as_an_attribute_is_none_that_is_read():
    place, reader = module("gain = 1.0\ndef law(p):\n    return p.gain"), Reader()
    reader.identity(place.law)
    place.gain = 2.0
    assert reader.current()


def test_functions_that_all_call_each_other_are_read_once():
    every = range(40)
    calls = " + ".join(f"f{i}(x)" for i in every)
    text = "\n".join(f"def f{i}(x):\n    return {calls}" for i in every)
    one, other = (identity(module(text).f0) for _ in range(2))
    assert hash(one) == hash(other) and one == other


def test_containers_in_themselves():
    gains = []
    gains.append(gains)
    assert identity(lambda: gains)


@pytest.mark.extra("heyoka")
class TestLanesOfAnEditedLaw:
    """A stance whose torques are added to: what is compiled follows every edit."""

    TEXT = """
EXTRA = 0.0
def added(own):
    def law(t, q, v, held, p, dyn, ops, by=0.0):
        hip, knee = own(t, q, v, held, p, dyn, ops)
        return hip + by, knee + by + EXTRA
    return law
"""

    def system(self, hop, place):
        def edited(domain):
            return replace(domain, law=place.added(domain.law)) if domain.phase == "stance" else domain

        return replace(hop.system, domains=tuple(map(edited, hop.system.domains)))

    def heights(self, system, hop):
        q, v = (np.tile(part, (2, 1)) for part in hop.state)
        return simulate_many(system, q, v).q[:, 0]

    @pytest.mark.parametrize("edit", ["by=0.0", "EXTRA = 0.0"])
    def test_edited_source(self, hop, edit):
        text = self.TEXT.replace(edit, edit.replace("0.0", "0.3"))
        before = self.heights(self.system(hop, module(self.TEXT)), hop)
        after = self.heights(self.system(hop, module(text)), hop)
        assert abs(after - before).min() > 1e-6

    def test_global_bound_anew_in_the_same_system(self, hop):
        place = module(self.TEXT)
        system = self.system(hop, place)
        before = self.heights(system, hop)
        place.EXTRA = 0.3
        assert abs(self.heights(system, hop) - before).min() > 1e-6
        place.EXTRA = 0.0
        np.testing.assert_array_equal(self.heights(system, hop), before)

    def test_partial(self, hop):
        def added(domain, by):
            law = partial(module(self.TEXT).added(domain.law), by=by)
            return replace(domain, law=law) if domain.phase == "stance" else domain

        none, some = (
            replace(hop.system, domains=tuple(added(domain, by) for domain in hop.system.domains)) for by in (0.0, 0.3)
        )
        assert abs(self.heights(some, hop) - self.heights(none, hop)).min() > 1e-6

    def test_springs_moved_to_another_joint(self, hop):
        def moved(domain):
            return replace(domain, mounts=tuple(replace(mount, rest="flexing") for mount in domain.mounts))

        domains = tuple(map(moved, hop.system.domains))
        assert abs(self.heights(replace(hop.system, domains=domains), hop) - self.heights(hop.system, hop)).min() > 1e-6

    def test_gains_changed_in_place(self, hop):
        gains = [0.0]

        def added(domain):
            def law(*arguments):
                return [torque + gains[0] for torque in domain.law(*arguments)]

            return replace(domain, law=law) if domain.phase == "stance" else domain

        system = replace(hop.system, domains=tuple(map(added, hop.system.domains)))
        before = self.heights(system, hop)
        gains[0] = 0.3
        assert abs(self.heights(system, hop) - before).min() > 1e-6
