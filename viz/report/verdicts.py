"""Verdicts in the report as HTML: how each is marked, what it says, and what an assumption does to it."""

from __future__ import annotations

from spear_pin.studies.audit.statements import ASSUMPTIONS, RULES, Assumption, Verdict
from spear_pin.viz.report.text import text

MARKS: dict[Verdict, tuple[str, str]] = {  # class and sign
    "agrees": ("agrees", "✓"),
    "differs": ("differs", "≠"),
    "by construction": ("built", "≡"),
    "cannot be known": ("unknown", "?"),
    "failed": ("failed", "!"),
}


def badge(verdict: Verdict) -> str:
    """A verdict in words, with its sign."""
    kind, sign = MARKS[verdict]
    return f'<span class="badge {kind}"><i aria-hidden="true">{sign}</i>{verdict}</span>'


def rules() -> str:
    """Meaning of each verdict, but for failures, which are none."""
    return "".join(f"<p>{badge(verdict)} {rule}</p>" for verdict, rule in RULES.items() if verdict != "failed")


def assumptions() -> str:
    """A row of a table for each assumption."""
    return "".join(
        f'<tr id="assumption-{each.id}"><th>{text(each.what)}</th><td>{text(each.here)}'
        f'<p class="remark">{text(_consequence(each))}</p></td></tr>'
        for each in ASSUMPTIONS
    )


def _consequence(assumption: Assumption) -> str:
    """Effect of an assumption on the verdicts that rest on it."""
    if assumption.others:
        labels = ", ".join(other.label for other in assumption.others)
        return f"What rests on it is looked at with others, too: {labels}."
    if assumption.settled:
        return f"What rests on it is judged all the same: {assumption.settled}."
    return "It stands in for what is not known: nothing that rests on it agrees or differs."
