"""Audit of the source: its numbers and equations as printed, `runs` that check them, `statements`, and `errata`."""
