"""The report: every statement checked, every figure drawn, every table made, as one page that asks for nothing.

`pictures` says which figure of the source each plot answers, `drawings` draws it with its runs; `page` is the HTML.
"""

from spear_pin.viz.report.making import SVG, Report, Selection, make, select, write_figures

__all__ = ["SVG", "Report", "Selection", "make", "select", "write_figures"]
