"""Many lanes at once: groups of lanes, their numbers, the domains they enter, and integration between events."""
