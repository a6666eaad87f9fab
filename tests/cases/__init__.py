"""Inputs that are easily read wrong, each with what is right and how that was found.

`python -m tests.cases` prints them, and with words those whose kind or name contains all of them. A module of this
package that has `CASES`, a sequence of `Case`, adds its rows.
"""
