"""The report: every statement checked, every figure drawn, every table made, as one page that loads nothing else.

`pictures` says which figure of the source each plot shows, `drawings` draws it with its runs, and `page` makes the
HTML.
"""

from spear_pin.viz.report.making import SVG, Report, Selection, make, select, write_figures

__all__ = ["SVG", "Report", "Selection", "make", "select", "write_figures"]
