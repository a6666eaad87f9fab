"""Orbits in space: gaits of the plane put there, kept in balance, and turning."""
