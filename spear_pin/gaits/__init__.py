"""Gaits of the robot: control laws, their automata, gait search."""
