"""Cards for notebooks: a table with units and a small drawing, in the colours of the notebook's own text."""

from spear_pin.viz.notebook.cards import card

__all__ = ["card"]
