"""Measures of a cycle: what each name means, in one table, and their values from the samples of a motion."""
