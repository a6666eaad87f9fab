"""What a document says and a grammar does not read: what is named, how, and what is passed over."""

import pytest
from lxml import etree

from spear_pin.model.unread import Grammar, Unread, find_unread

GRAMMAR = Grammar(
    read={"robot": "", "robot/joint": "type", "robot/joint/limit": "lower", "robot/joint/joint": "", "robot/bag": ""},
    single=frozenset({"robot/joint/limit"}),
    idle=frozenset({"visual", "sensor"}),
    still=frozenset({"name"}),
    usual={"limit@soft": ("0", "false"), "stiffness": ("0",)},
)


def line(inside, **options):
    unread = Unread()
    root = etree.fromstring(f'<robot name="r" xmlns:o="http://o.org/o">{inside}</robot>')
    find_unread(root, GRAMMAR, unread, **options)
    return unread.line


@pytest.mark.parametrize(
    "inside",
    [
        "",
        '<joint name="a" type="t"><limit lower="1"/></joint>',
        '<joint name="a"><limit soft="0.0"/></joint><joint name="b"><limit soft=" False "/></joint>',
        '<visual spring="9"/><joint><visual><limit/></visual></joint>',
        "<bag><stiffness>0</stiffness><wrap><sensor/></wrap></bag>",
        '<sensor:ray xmlns:sensor="http://s" name="a"/>',
        '<joint name="a"><joint name="b"/></joint>',
        '<x:property xmlns:x="http://www.ros.org/wiki/xacro" name="a"/><joint xml:base="there"/>',
    ],
)
def test_nothing(inside):
    assert line(inside) is None


@pytest.mark.parametrize(
    ("inside", "said"),
    [
        ('<joint name="a" kind="t"/>', "kind in <joint> of 'a'"),
        ('<joint name="a"><limit lower="1" upper="2"/></joint>', "upper in <limit> of 'a'"),
        ('<joint name="a"><limit soft="1"/></joint><joint name="b"><limit soft="2"/></joint>',
         "soft in <limit> of 'a', 'b'"),
        ('<joint name="a"><limit/><limit/></joint>', "a second <limit> in <joint> of 'a'"),
        ('<joint name="a"><joint name="b"><pull/></joint></joint>', "<pull> in <joint> of 'b'"),
        ('<bag><stiffness>3</stiffness><rest>1</rest></bag>', "<stiffness>, <rest> in <bag>"),
        ('<bag><wrap><sensor/><pull/></wrap></bag>', "<wrap> in <bag>"),
        ('<bag><wrap force="3"><sensor/></wrap></bag>', "<wrap> in <bag>"),
        ('<o:joint name="a"/>', "<o:joint> 'a'"),
        ('<joint name="a" o:pull="3"/>', "o:pull in <joint> of 'a'"),
        ('<weld body1="a" body2="b"/>', "<weld> 'a'"),
        ('<joint name="a" kind="t"/><pull name="p"/>', "kind in <joint> of 'a'; <pull> 'p'"),
        ("".join(f'<pull name="{i}"/>' for i in range(7)), "<pull> '0', '1', '2', '3' and 3 more"),
        ('<pull name="a&#10;b"/>', "<pull> 'a\\nb'"),
    ],
)  # fmt: skip
def test_named(inside, said):
    assert line(inside) == f"not taken over: {said}"


def test_what_is_known_is_passed_over():
    root = etree.fromstring('<robot><joint name="a"><pull/></joint><pull/></robot>')
    unread = Unread()
    find_unread(root, GRAMMAR, unread, known=[root[0][0], root[1]])
    assert unread.line is None


def test_attributes_of_a_class():
    """What an element has by its class counts as its own."""
    root, unread = etree.fromstring('<robot><joint name="a"/></robot>'), Unread()
    find_unread(root, GRAMMAR, unread, lambda element: {"pull": "3"} if element.tag == "joint" else {})
    assert unread.line == "not taken over: pull in <joint> of 'a'"
