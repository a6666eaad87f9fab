"""Quadrupeds that bound in three dimensions: legs, law, automaton."""
