"""Motions whose numbers are turned by hand: `knobs` of `legs` and `bounds`, `engines` and `figures` of them."""
