"""The law of a gait as a C99 controller: source, header, test and note."""
