"""How the robot moves: contact, the automaton as data, event-exact simulation, periodic orbits."""
