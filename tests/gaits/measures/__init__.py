"""Measures of a cycle, by their names."""
