"""Exact derivatives of a cycle: dual numbers, the record of a cycle, and how derivatives pass arcs and events."""
