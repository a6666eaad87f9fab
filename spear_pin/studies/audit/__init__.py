"""The source audited: its numbers and equations as printed, the `runs` that answer it, `statements`, and `errata`."""
