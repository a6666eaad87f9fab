"""Gaits of quadrupeds in space by collocation, as footfalls: which feet bear, in order."""
