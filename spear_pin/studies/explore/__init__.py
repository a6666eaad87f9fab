"""The hop with its numbers turned by hand: `knobs`, `engines` that follow it, the `hops` that come, their `figures`."""
