"""Gaits of the robot: control laws, their automata, and the search for gaits."""
