"""Files that were made to do harm, some two hundred, and whether each is withstood: `python -m tests.hostile`."""
