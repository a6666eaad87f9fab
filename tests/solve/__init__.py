"""Gaits that take minutes to find: found by `python -m tests.solve`, kept in `tests/solved`, verified in the gate."""
