"""What the robot is made to do: control laws, their automata, gait search."""
