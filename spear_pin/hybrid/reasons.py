"""Reasons why runs end."""

REASONS = {
    "complete": "all cycles were run",
    "below_ground": "a toe was below the ground at the beginning",
    "open_loop": "a closed loop was open at the beginning, or its ends parted",
    "fall": "a part other than a toe reached the ground",
    "toggle": "a closed loop reached a toggle, where its motors do not determine its joints any more",
    "limit": "a joint reached the end of its range",
    "zeno": "events accumulate: laws of phases that alternate undo each other, or hysteresis holds a spring",
    "no_cycle": "a thousand events passed and no cycle closed",
    "painleve": "the slip equation has no unique solution (Painlevé's paradox)",
    "overload": "the control law asked for more torque than any motor has: near a singularity or far from its gait",
    "no_event": "a phase went on beyond its time limit",
    "lifted": "a brake lifted a toe off the ground, and no event leads on from there",
    "stuck": "dry friction holds a joint, and nothing frees it within the time limit of the phase",
    "step_size": "the integrator's step size fell to nothing",
    "evaluation_cap": "the run used up its right-hand side evaluations",
    "not_finite": "the state is no longer finite",
}
NUMERICAL = ("step_size", "evaluation_cap", "not_finite")
