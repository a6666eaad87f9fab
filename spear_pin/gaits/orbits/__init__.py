"""Orbits in space: planar gaits put into space, balanced by feedback, and turning."""
