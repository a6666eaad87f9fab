"""The robot: its description, its dynamics, its spring."""
