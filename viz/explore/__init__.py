"""The page on which a user changes the numbers of a motion, and its local server."""
