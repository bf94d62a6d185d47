"""What a run says when it leaves what the proofs assume (docs/prove.md): a sentence each."""

from collections.abc import Callable
from typing import Any

from innervate.networks.skin.sim import proved

STILL = "takes a route although {other} has an old one of it still"
WORDS = {
    proved.RESTART: f"{{node}}, which was restarted, {STILL} (Restart)",
    proved.HOLD: f"{{node}}, which forgot its feasible distance, {STILL} (FD_HOLD)",
    proved.NUMBERS: "numbers in use do not lie within half of all, the oldest at {node} (Numbers)",
    proved.FIRST_START: "{node} is switched on as if it never was before (First start)",
    proved.PC_STAYS: "under rule strict the PC is restarted",
    proved.ORDER: "under rule strict a beacon from {other} comes to {node} behind a newer one "
    "(Order)",
}


def outside(rows: Any, label: Callable[[int], str]) -> list[str]:
    """A sentence for each assumption that was left, the first time."""
    found = rows[rows["code"] == proved.OUTSIDE]
    return [sentence(int(at), what, label(node), label(other) if other >= 0 else "")
            for at, node, _code, what, other in found.tolist()]  # fmt: skip


def sentence(at_us: int, what: int, node: str, other: str) -> str:
    """One sentence: from when on, what was left, and where."""
    words = WORDS[what].format(node=node, other=other)
    return f"outside what is proved from {at_us / 1e6:.6f} s on: {words}"
