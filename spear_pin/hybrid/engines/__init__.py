"""Engines: each assembles the right-hand sides of an automaton's domains from the same data."""
