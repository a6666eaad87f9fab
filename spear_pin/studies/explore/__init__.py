"""Motions whose numbers a user changes by hand: `knobs` of `legs` and `bounds`, with `engines` and `figures`."""
