"""Quadrupeds that run in three dimensions: legs, laws, automata."""
