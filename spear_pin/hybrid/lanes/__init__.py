"""Many lanes at once: groups in the same domain, their numbers, what they enter, and their way from event to event."""
