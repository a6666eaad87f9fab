"""Tolerances to which fixed points are solved, one at a time or many."""

SETTLE = 12  # cycles of simulation before Newton's method
TOLERANCE = 1e-10  # tolerance of Newton's method, or the integrator's where that is finer
RESIDUAL = 1e-9
