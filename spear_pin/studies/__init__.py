"""Studies of the robot, built on gaits and simulations."""
