"""Calls that are wrong, some thousands, and whether each is answered as it should: `python -m tests.wrong_calls`."""
