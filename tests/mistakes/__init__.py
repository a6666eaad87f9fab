"""Mistakes made on purpose, as data, by the layer that they are made in."""

from tests.mistakes import cycles, fronts, gaits, hybrid, logs, model, rules, springs, tangents
from tests.mistakes.mutation import Mutation

__all__ = ["MUTATIONS", "Mutation"]

MUTATIONS = [
    *model.MUTATIONS,
    *hybrid.MUTATIONS,
    *springs.MUTATIONS,
    *rules.MUTATIONS,
    *cycles.MUTATIONS,
    *tangents.MUTATIONS,
    *gaits.MUTATIONS,
    *logs.MUTATIONS,
    *fronts.MUTATIONS,
]
