"""Measures of a cycle: the meaning of each name in one table, and values from the samples of a motion."""
