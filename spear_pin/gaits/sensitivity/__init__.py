"""How a gait changes with any number: exact derivatives of its state, its measures and its multipliers."""
