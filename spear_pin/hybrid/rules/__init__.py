"""The book of rules: what hybrid motion does in each situation, once for every engine and runner.

A rule is a pure function of numbers, or of arrays with one entry for each lane; it neither integrates nor keeps
anything. Its tolerances stand beside it.
"""
