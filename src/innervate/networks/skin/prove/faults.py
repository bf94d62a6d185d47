"""Mistakes that a proof must refute, beside those of the explorer's that concern an invariant."""

from __future__ import annotations

from innervate.prove.theory import Fault

# Of the explorer's mutants: mistakes that no invariant is about.
NO_SAFETY: dict[str, str] = {}

FAULTS = tuple(
    Fault(*texts)
    for texts in (
        ("who has a route does not ask the rule when it hears",
         "not (is_usable(cell, params, port) and is_allowed(cell, params, port))",
         "not (is_usable(cell, params, port) and (parent != NONE or "
         "is_allowed(cell, params, port)))"),
        ("who has a route does not ask the rule at its tick",
         "            if is_allowed(cell, params, p):\n",
         "            if cell.parent != NONE or is_allowed(cell, params, p):\n"),
        ("the choice among equals does not ask the rule",
         "p != cell.parent and is_usable(cell, params, p) and is_allowed(cell, params, p):",
         "p != cell.parent and is_usable(cell, params, p):"),
        ("the feasible distance is forgotten after 3 periods",
         "if cell.hold >= params.hold_periods:", "if cell.hold >= 3:"),
        ("periods without a route count twice",
         "cell.hold = cell.hold + 1", "cell.hold = cell.hold + 2"),
    )
)  # fmt: skip
