"""Gaits of quadrupeds in space by collocation, from footfalls: the order in which feet are on the ground."""
