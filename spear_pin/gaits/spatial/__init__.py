"""Quadrupeds that bound in three dimensions: legs, law, automaton, and gaits of the plane put into space."""
