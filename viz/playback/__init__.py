"""A robot in motion as a scene for meshcat's viewer: links, springs, forces and paths, frame by frame."""
