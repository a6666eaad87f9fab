"""Playback: a recorded page that needs nothing but a browser, and a live viewer."""
