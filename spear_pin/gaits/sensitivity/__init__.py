"""What a change of any number does to a gait: exact derivatives of its state, its measures and its multipliers."""
