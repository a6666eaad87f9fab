"""Lines of a command's text."""

from spear_pin.cli.output import aligned


def test_long_names_widen_their_column():
    short, long = ("files", "hop.html"), ("anterior_left_knee_stiffness", "112")
    assert aligned(iter([short])) == f"{'files':<21}hop.html"
    assert aligned(iter([short, long])) == f"{'files':<29}hop.html\nanterior_left_knee_stiffness 112"
