"""Tables of numbers of any origin: how they are written, their clock, their units."""
