"""What `innervate prove mesh` claims: a packet is delivered once, and passed on once, within reach.

The router as a whole is too large to be unrolled; its duplicate caches decide both, and each of
their functions is proved by itself, of any contents. Two origins stand for any number.
"""

from functools import partial
from typing import Any

from innervate.dialect.arith import HALF16, MASK16
from innervate.dialect.source import Change
from innervate.networks.mesh.protocol import fields
from innervate.networks.mesh.protocol.duplicates import ANEW, BITS, FLOODED
from innervate.networks.mesh.protocol.fields import FORWARDED, WINDOW_WORDS
from innervate.networks.mesh.prove import hops
from innervate.prove.mutants import planted
from innervate.prove.records import Record, Store
from innervate.prove.steps import Goal, Stage, Step, own_goals
from innervate.prove.terms import Term
from innervate.prove.theory import Theory, whole_source

ENTRY = "innervate.networks.mesh.protocol.node"
ORIGINS = 2
ORIGIN = 1  # whose packet is looked at; 0 stands for all others
REACH = BITS * WINDOW_WORDS
# How far ahead of the newest a packet is: each way that the window can move, and not at all.
AHEAD = (*((k, k) for k in range(REACH + 1)), (REACH + 1, HALF16 - 1), (HALF16, MASK16))
DELIVERED = ("newest", "window", "heard_seq", "idle")
ASSUMED = (
    "Reach: a window holds the newest number of an origin and the 75 behind it; it begins anew "
    "after silence, or with a packet that says FIRST, is 320 behind or more, and did not do so "
    "before.",
    "A packet that is still on its way is less than 2^15 numbers behind.",
)
KEPT = (f"Reach: the {FORWARDED} packets that were noted last.",)
MUTANTS = planted(
    ("a packet that was delivered is delivered again",
     "    if ahead == 0:\n        return 0\n", "    if ahead == 0:\n        return 1\n"),
    ("what is behind the newest is new", "    if node.window[word] & bit:\n        return 0\n", ""),
    ("the window begins anew with every packet",
     "    if node.idle[origin] == 0:\n", "    if node.idle[origin] >= 0:\n"),
    ("what is behind is not noted", "    node.window[word] = node.window[word] | bit\n", ""),
    ("the packet that was newest is not in the window",
     "            if old == -1:\n", "            if old == -2:\n"),
    ("the window moves a place too far",
     "old = at * BITS + b - ahead\n", "old = at * BITS + b - ahead - 1\n"),
    ("a packet that was passed on is passed on again",
     "    if k >= 0 and node.done_kind[k] == kind:\n        return 1\n    clear_skipped",
     "    clear_skipped"),
    ("every packet is noted in the same place", "(k + 1) % FORWARDED", "k % FORWARDED"),
    ("who had the packet is asked again",
     "    if who == NONE or was_at(node, i, who):\n        return 0\n",
     "    if who == NONE:\n        return 0\n"),
    ("who failed for a packet is asked again",
     "q_seq[i], who):\n            who = NOBODY\n", "q_seq[i], 0):\n            who = who\n"),
    ("who transmits a packet is not in its path",
     "    node.q_path_len[i] = count + 1\n", "    node.q_path_len[i] = count\n"),
)  # fmt: skip


def theories(_network: Any, change: Change | None = None) -> list[Theory]:
    """At most one delivery, and nobody takes a packet twice, within the caches' reach."""
    known = whole_source(ENTRY, change)
    return [
        Theory("mesh, delivery", "A packet that was delivered is not delivered again.", ASSUMED,
               (partial(_again, known), partial(_first, known), partial(_other, known))),
        Theory("mesh, passing on", "A node takes a packet from others once for each try of its "
               "origin; what comes back is told by its path.", KEPT,
               (partial(_taken, known), partial(_noted, known))),
        *hops.theories(known),
    ]  # fmt: skip


# -- delivery: accept()


class Window:
    """What a node remembers of the packets of an origin, and one of them that it has delivered.

    All numbers are counted from the newest, so that a case is told by how far ahead one is.
    """

    def __init__(self, known: dict[str, Any]) -> None:
        self.stage = Stage(known, fields.FRAME, 8)
        self.t = self.stage.terms
        kept = [field for field in fields.packets(ORIGINS) if field[0] in DELIVERED]
        self.node = self.stage.record("node", kept)
        forget = [field for field in fields.PARAMS if field[0] == "forget"]
        self.params = self.stage.record("params", forget)
        self.newest = self.t.unknown("newest", 0, MASK16)
        self.stage.store[self.node, "newest", ORIGIN] = self.number(self.t.number(0))
        self.behind_before = self.t.unknown("behind", 0, HALF16 - 1)
        ahead = self.t.sub(self.t.number(MASK16 + 1), self.behind_before)
        self.seq = self.number(self.t.bits_and(ahead, self.t.number(MASK16)))
        self.first = self.t.unknown("first", 0, 1)

    def number(self, ahead: Term) -> Term:
        """The number that is so far ahead of the newest."""
        return self.t.wrapped(self.newest, ahead, MASK16)

    def behind(self, store: Store) -> Term:
        """How far the packet is behind the newest."""
        away = self.t.sub(store[self.node, "newest", ORIGIN], self.seq)
        return self.t.bits_and(away, self.t.number(MASK16))

    def is_open(self, store: Store) -> Term:
        """The window of its origin is not over."""
        return self.t.less(self.t.number(0), store[self.node, "idle", ORIGIN])

    def is_noted(self, store: Store) -> Term:
        """The packet is noted as delivered, if it is within reach."""
        t, behind = self.t, self.behind(store)
        parts = []
        for k in range(REACH):
            bits = store[self.node, "window", ORIGIN * WINDOW_WORDS + k // BITS]
            is_set = t.as_truth(t.bits_and(bits, t.number(1 << (k % BITS))))
            parts.append(t.implies(t.same(behind, t.number(k + 1)), is_set))
        return t.all(*parts)

    def accept(self, origin: int, seq: Term) -> tuple[Store, Term]:
        """The values after a packet of some origin, and whether it is delivered."""
        args = [self.node, self.params, origin, seq, self.first]
        after, result = self.stage.machine.run("accept", args, self.stage.store)
        return after, self.t.as_truth(result)

    def step(self, name: str, after: Store, facts: list[Term], goals: list[Goal]) -> Step:
        """What was run as a step; fields stay in range and indices in arrays, too."""
        step = self.stage.step(name, after, facts, [])
        step.singly, step.goals = True, [*own_goals(step, ("node",), 0, 0), *goals]
        return step

    def state(self) -> list[Term]:
        """It was delivered, and its window is open."""
        return [self.is_open(self.stage.store), self.is_noted(self.stage.store)]


def _again(known: dict[str, Any]) -> Step:
    window = Window(known)
    t = window.t
    after, taken = window.accept(ORIGIN, window.seq)
    near = t.at_most(window.behind_before, t.number(ANEW))
    once = t.any(near, t.same(window.first, t.number(0)))
    goals = [
        Goal("D1 it is not delivered again", t.implies(once, t.negated(taken))),
        Goal("D2 it stays noted", t.any(taken, window.is_noted(after))),
    ]
    return window.step("it comes again", after, window.state(), goals)


def _first(known: dict[str, Any]) -> Step:
    window = Window(known)
    t = window.t
    goals, after = [], window.stage.store
    for low, high in AHEAD:
        seq = window.number(t.unknown(f"ahead {low}", low, high))
        after, taken = window.accept(ORIGIN, seq)
        window.seq = seq
        noted = t.all(window.is_open(after), window.is_noted(after),
                      t.at_most(window.behind(after), t.number(REACH)))  # fmt: skip
        goals.append(t.implies(taken, noted))
    return window.step("it is delivered", after, [],
                       [Goal("D3 it is noted, and within reach", t.all(*goals))])  # fmt: skip


def _other(known: dict[str, Any]) -> Step:
    window = Window(known)
    t = window.t
    after, _ = window.accept(1 - ORIGIN, t.unknown("other", 0, MASK16))
    goals = [t.all(window.is_open(after), window.is_noted(after))]
    for low, high in AHEAD:
        ahead = t.unknown(f"ahead {low}", low, high)
        after, _ = window.accept(ORIGIN, window.number(ahead))
        old = t.less(ahead, t.number(MASK16 - ANEW + 1))
        anew = t.all(t.same(window.first, t.number(1)), t.truth_of(low >= HALF16), old)
        goals.append(t.any(anew, t.all(window.is_open(after), window.is_noted(after))))
    stays = Goal("D4 it stays noted, unless the window begins anew", t.all(*goals))
    return window.step("another comes", after, window.state(), [stays])


# -- passing on: record_packet()


def _cache(known: dict[str, Any]) -> tuple[Stage, Record, Record, Term]:
    """A node's cache of packets that were passed on, a frame, and the frame's kind there."""
    stage = Stage(known, fields.FRAME, 8)
    kept = [field for field in fields.packets(ORIGINS)
            if field[0].startswith(("done_", "skip_"))]  # fmt: skip
    node, frame = stage.record("node", kept), stage.record("frame", fields.FRAME)
    return stage, node, frame, hops.cached_kind(stage, frame)


def _is_it(stage: Stage, node: Record, frame: Record, store: Store, k: int) -> Term:
    """Place k holds the frame's packet, of either parity."""
    t = stage.terms
    kind = t.bits_and(store[node, "done_kind", k], t.number(63))
    return t.all(
        t.same(store[node, "done_origin", k], stage.store[frame, "origin", None]),
        t.same(store[node, "done_seq", k], stage.store[frame, "seq", None]),
        t.same(kind, stage.store[frame, "kind", None]),
    )


def _taken(known: dict[str, Any]) -> Step:
    stage, node, frame, kind = _cache(known)
    t = stage.terms
    here = [_is_it(stage, node, frame, stage.store, k) for k in range(FORWARDED)]
    place = t.unknown("place", 0, FORWARDED - 1)
    once = [t.implies(one, t.same(place, t.number(k))) for k, one in enumerate(here)]
    flood = t.same(stage.store[frame, "kind", None], t.number(FLOODED))
    facts = [*once, t.negated(flood)]
    step = stage.play("a packet comes from another node", "record_packet", [node, frame], facts)
    step.goals = own_goals(step, ("node",), 0, 0)
    same = [t.all(one, t.same(step.before[node, "done_kind", k], kind))
            for k, one in enumerate(here)]  # fmt: skip
    known_before = t.any(*same)
    now = t.any(*(t.all(_is_it(stage, node, frame, step.after, k),
                        t.same(step.after[node, "done_kind", k], kind))
                  for k in range(FORWARDED)))  # fmt: skip
    refused = t.same(t.as_number(step.result), t.number(1))
    step.goals += [
        Goal("H1 one that was taken is not taken again", t.same(known_before, refused)),
        Goal("H2 one that is taken is noted", now),
    ]
    return step


def _noted(known: dict[str, Any]) -> Step:
    stage, node, frame, _ = _cache(known)
    t = stage.terms
    place = t.unknown("place", 0, FORWARDED - 1)
    step = stage.play("another packet is noted", "record_packet", [node, frame], [])
    step.goals = own_goals(step, ("node",), 0, 0)
    kept = []
    for k in range(FORWARDED):
        other = t.negated(_is_it(stage, node, frame, step.before, k))
        is_next = t.same(step.before[node, "done_at", None], t.number(k))
        same = t.all(*(t.same(step.before[node, name, k], step.after[node, name, k])
                       for name in ("done_origin", "done_seq", "done_kind")))  # fmt: skip
        kept.append(t.implies(t.all(t.same(place, t.number(k)), other, t.negated(is_next)), same))
    moved = t.sub(step.after[node, "done_at", None], step.before[node, "done_at", None])
    by = t.bits_and(moved, t.number(FORWARDED - 1))
    there = t.any(*(_is_it(stage, node, frame, step.before, k) for k in range(FORWARDED)))
    moves = t.same(by, t.pick(there, t.number(0), t.number(1)))
    step.goals += [
        Goal("H3 every other packet stays noted but the oldest", t.all(*kept)),
        Goal("H4 the place of the oldest moves on by one for one that is new", moves),
    ]
    return step
