"""[script]: steps that replace the clock, so that a counterexample is a scenario.

- "tick n1": the node's period is over
- "soon n1": its timer for a triggered beacon fires
- "deliver n1->n2": the oldest frame under way from n1 arrives at n2; "n1.2->n2.0" says on which
  cable
- "lose n1->n2": that frame is lost
- "detect n1.2": n1 misses one more beacon on its port 2, and with its next tick finds it broken
- "draw 3": the next random choice returns 3
- "cut n1->n2", "restore n1->n2": the cable fails, with all frames on it, or works again
- "restart pc": the node loses its memory

With `keepalive` every cable that `detect` does not name has brought something before each tick.
"""

from dataclasses import dataclass

from innervate.networks.skin.scenario.graph import Named
from innervate.networks.skin.scenario.model import ScriptTable
from innervate.networks.skin.scenario.targets import find_link
from innervate.scenario.lines import Key

TICK, DELIVER, STEP_LOSE, DETECT, DRAW, SOON, STEP_CUT, STEP_RESTORE, STEP_RESTART = range(9)
STEP_NAMES = (
    "tick", "deliver", "lose", "detect", "draw", "soon", "cut", "restore", "restart",
)  # fmt: skip
ON_CABLE = (DELIVER, STEP_LOSE, STEP_CUT, STEP_RESTORE)
DRAW_MAX = 2**30 - 1


@dataclass(frozen=True, slots=True)
class Step:
    """One step of a script, as read."""

    # TICK, SOON, DELIVER, STEP_LOSE, DETECT, DRAW, STEP_CUT, STEP_RESTORE or STEP_RESTART.
    action: int
    node: int = -1  # who acts or receives; -1 for a draw
    # Where the frame was sent from (deliver, lose), one end of the cable (cut, restore) or which is
    # broken (detect); else -1.
    end: int = -1
    value: int = 0  # what the draw returns, 0 .. 2^30-1


def steps(named: Named, script: ScriptTable) -> tuple[Step, ...]:
    """The steps of a script.

    Raises:
        ScenarioError: a step that cannot be read, or names what is not there.
    """
    return tuple(
        _step(named, text, ("script", "steps", index)) for index, text in enumerate(script.steps)
    )


def _step(named: Named, text: str, key: Key) -> Step:
    verb, _, rest = text.strip().partition(" ")
    rest = rest.strip()
    if verb not in STEP_NAMES or not rest:
        message = f'"{text[:60]}" is no step; they are tick n, soon n, deliver a->b'
        others = "cut a->b, restore a->b, restart n"
        raise named.wrong(key, f"{message}, lose a->b, detect n.port, draw v, {others}")
    action = STEP_NAMES.index(verb)
    if action == DRAW:
        if not (rest.isascii() and rest.isdigit() and len(rest) < 11 and int(rest) <= DRAW_MAX):
            raise named.wrong(key, "draw takes a whole number below 2^30")
        return Step(DRAW, value=int(rest))
    if action in ON_CABLE:
        a, arrow, b = rest.partition("->")
        if not arrow:
            raise named.wrong(key, f"{verb} takes two nodes, like {verb} n1->n2")
        there = named.node_and_port(b, key)
        end = find_link(named.graph, named.node_and_port(a, key), there)
        if end < 0:
            raise named.wrong(key, f"no cable leads from {a[:60]} to {b[:60]}")
        return Step(action, there[0], end)
    node, port = named.node_and_port(rest, key)
    if action in (TICK, SOON, STEP_RESTART):
        if port >= 0:
            raise named.wrong(key, f"{verb} takes a node, not a port; leave the port out")
        return Step(action, node)
    if port < 0 or node == named.graph.cells:
        raise named.wrong(key, "detect takes a cell's port, like detect n1.2")
    return Step(DETECT, node, named.graph.end(node, port))
