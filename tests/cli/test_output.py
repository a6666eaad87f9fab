"""Lines of a command's text."""

from spear_pin.cli.output import align_lines


def test_long_names_widen_their_column():
    short, long = ("files", "hop.html"), ("anterior_left_knee_stiffness", "112")
    assert align_lines(iter([short])) == f"{'files':<21}hop.html"
    assert align_lines(iter([short, long])) == f"{'files':<29}hop.html\nanterior_left_knee_stiffness 112"
