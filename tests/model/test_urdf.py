"""Reading URDFs: what is extracted, and that Pinocchio's parser reads the same or the file is refused."""

import pytest

from spear_pin.errors import BadFile, SpearError
from spear_pin.model.gears import Gear
from spear_pin.model.loading import ROBOTS, load
from spear_pin.model.urdf import read_urdf
from tests.model.planar_arm import ARM, ELBOW_LIMIT, edited, refusal

ELBOW_DRIVE = '<transmission name="t"><joint name="elbow"/><actuator name="m"/></transmission></robot>'


class TestRead:
    def test_arm(self, write):
        path = write(ARM)
        urdf = read_urdf(path)
        assert (urdf.path, urdf.name) == (path, "arm")
        assert urdf.transmissions == {"shoulder": Gear(50.0, 2e-5)}
        assert urdf.transmissions["shoulder"].reflected == pytest.approx(0.05)

    def test_path_as_text(self, write):
        path = write(ARM)
        assert read_urdf(str(path)) == read_urdf(path)

    def test_reduction_alone(self, write):
        text = edited('<drake:gear_ratio value="50"/>', "")
        assert read_urdf(write(text)).transmissions == {"shoulder": Gear(50.0, 2e-5)}

    def test_ratio_alone(self, write):
        text = edited("<mechanicalReduction>50</mechanicalReduction>", "")
        assert read_urdf(write(text)).transmissions == {"shoulder": Gear(50.0, 2e-5)}

    def test_motor_without_numbers(self, write):
        urdf = read_urdf(write(edited("</robot>", ELBOW_DRIVE)))
        assert urdf.transmissions["elbow"] == Gear(None, None)
        assert urdf.transmissions["elbow"].reflected is None

    def test_comments_are_dropped(self, write):
        text = edited(">50<", "> 5<!-- fifty -->0 <")
        urdf = read_urdf(write(text))
        assert urdf.transmissions["shoulder"].ratio == 50.0
        assert "fifty" not in urdf.text

    def test_utf_16(self, write):
        text = edited('<?xml version="1.0"?>', '<?xml version="1.0" encoding="utf-16"?>')
        assert read_urdf(write(text.encode("utf-16"))).transmissions == read_urdf(write(ARM)).transmissions

    def test_inertia_on_the_verge(self, write):
        """A thin rod has no moment about its axis; rounding may not make it invalid."""
        text = edited('ixx="0.03" ixy="0" ixz="0" iyy="0.02"', 'ixx="0.03" ixy="0.03" ixz="0" iyy="0.03"')
        assert read_urdf(write(text)).name == "arm"

    @pytest.mark.parametrize(
        ("name", "expected"),
        [
            ("spear_ii", {"hip": (60, 0.047), "knee": (15, 0.027)}),
            (
                "q_spear",
                {
                    "posterior_hip": (60, 0.094),
                    "posterior_knee": (15, 0.054),
                    "anterior_hip": (60, 0.094),
                    "anterior_knee": (15, 0.054),
                },
            ),
        ],
    )
    def test_shipped(self, name, expected):
        found = read_urdf(ROBOTS[name].path).transmissions
        assert {joint: gear.ratio for joint, gear in found.items()} == {joint: n for joint, (n, _) in expected.items()}
        for joint, gear in found.items():
            assert gear.reflected == pytest.approx(expected[joint][1], rel=1e-12)


class TestStricterThanTheParser:
    """What the reader lets through, Pinocchio's parser must read the same way, in silence."""

    @pytest.mark.parametrize(
        ("old", "new", "says"),
        [
            ('<origin xyz="0 0 -0.1"/>', '<origin xyz="0 -0.1"/>', "0 -0.1"),
            ('<origin xyz="0 0 -0.1"/>', '<origin xyz="0 0 -O.1"/>', "-O.1"),
            ('<origin xyz="0 0 -0.1"/>', '<origin xyz="0 0 nan"/>', "nan"),
            ('<origin xyz="0 0 -0.1"/>', '<origin rpy="0 0"/>', "rpy"),
        ],
    )
    def test_inertial_is_not_lost(self, write, capfd, old, new, says):
        assert says in refusal(write(edited(old, new)), load).problem
        assert capfd.readouterr().err == ""

    @pytest.mark.parametrize("value", ["2.0 ", "2", "0.2e1", "\u0662"])
    def test_number_in_another_notation(self, write, capfd, value):
        assert load(write(edited('mass value="2.0"', f'mass value="{value}"'))).mass == load(write(ARM)).mass
        assert capfd.readouterr().err == ""

    @pytest.mark.parametrize(
        ("old", "new", "says"),
        [
            (ELBOW_LIMIT, "", "elbow"),
            (ELBOW_LIMIT, ELBOW_LIMIT.replace(' effort="10"', ""), "effort"),
            (ELBOW_LIMIT, ELBOW_LIMIT.replace("-2", "two"), "two"),
            ('<origin xyz="0 0 -0.3"/>', '<origin xyz="0 0"/>', "0 0"),
            ('<origin xyz="0 0 -0.3"/>', '<origin rpy="0 0 x"/>', "x"),
        ],
    )
    def test_fault_is_named(self, write, capfd, old, new, says):
        assert says in refusal(write(edited(old, new)), load).problem
        assert capfd.readouterr().err == ""

    def test_nameless_robot_is_named_after_its_file(self, write, capfd):
        assert load(write(edited('<robot name="arm"', "<robot"))).name == "arm"
        assert capfd.readouterr().err == ""

    @pytest.mark.parametrize("shape", ["<visual/>", '<visual><geometry><box size="a"/></geometry></visual>'])
    def test_shapes_are_ignored_in_silence(self, write, capfd, shape):
        assert load(write(edited('<link name="base"/>', f'<link name="base">{shape}</link>'))).nv == 2
        assert capfd.readouterr().err == ""

    def test_processing_instruction(self, write, capfd):
        assert load(write(edited('<link name="base"/>', '<?editor fold?><link name="base"/>'))).nv == 2
        assert capfd.readouterr().err == ""

    @pytest.mark.parametrize(
        ("old", "new"),
        [('ixx="0.03"', 'ixx="1e150"'), ('ixy="0"', 'ixy="1e200"'), ('value="50"', 'value="1e200"')],
    )
    def test_overflow(self, write, old, new):
        text = edited("<mechanicalReduction>50</mechanicalReduction>", "")
        refusal(write(edited(old, new, text)), load)

    @pytest.mark.parametrize(("old", "new"), [("-0.2", "1e200"), ('mass value="1.0"', 'mass value="1e308"')])
    def test_mass_matrix_that_overflows(self, write, old, new):
        refusal(write(edited(old, new)), load)

    def test_line_break_in_the_path(self, tmp_path):
        with pytest.raises(BadFile) as caught:
            read_urdf(tmp_path / "a\nb.urdf")
        assert "\n" not in str(caught.value)

    @pytest.mark.parametrize("path", ["a\0.urdf", "\ud800.urdf"])
    def test_impossible_path(self, path):
        with pytest.raises(SpearError):
            read_urdf(path)
