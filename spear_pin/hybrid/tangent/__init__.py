"""Exact derivatives of a cycle: dual numbers, the record of a cycle, and derivatives along arcs and across events."""
