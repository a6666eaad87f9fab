"""What is asked of the robot: studies built on gaits and simulations."""
