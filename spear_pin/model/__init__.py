"""What the robot is: its description, its dynamics, its spring."""
