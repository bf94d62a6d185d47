"""Which hops a packet takes under `search`: none forward to who had it, and some back, twice.

A packet carries the nodes that have transmitted it, its path. Whom a search asks next stands in no
path and has not failed for it; else the packet goes back to whom it came from. So no copy of a
packet comes forward to a node twice. A packet of which lost acks made two copies may go back over
one hop twice, which is told as a story of three nodes.
"""

from functools import partial
from typing import Any

from innervate.networks.mesh.protocol import fields
from innervate.networks.mesh.protocol.constants import NOBODY, PARITY, PATH_MAX, SEARCH
from innervate.networks.mesh.protocol.fields import FORWARDED, SKIPS
from innervate.prove.answers import Answers
from innervate.prove.records import Record, Store
from innervate.prove.solve import Question
from innervate.prove.steps import Goal, Stage, Step
from innervate.prove.terms import Term
from innervate.prove.theory import Theory

SIZE = 2  # neighbours and recipients that stand for all
LOOKED_UP = ("was_at", "is_skipped", "giver")  # whatever they answer
CLAIM = "No copy of a packet goes forward to a node that had it, or that failed for it."
KEPT = (
    f"Failures: the {SKIPS} that a node noted last, of all packets.",
    f"A path holds {PATH_MAX} nodes; who is in it does not enter it again.",
)
UNREACHABLE = {
    ("search", "if params.failover != SEARCH:", True): "search is what is proved",
}
TWICE = "a packet comes back twice"
ONCE = "a packet that came back is not taken back again"


def theories(known: dict[str, Any]) -> list[Theory]:
    """What is so of hops, and what is not."""
    steps = (_chosen, _entered, _stored, _failed)
    return [
        Theory("mesh, hops", CLAIM, KEPT, tuple(partial(one, known) for one in steps),
               UNREACHABLE),
        Theory("mesh, hops back", "No packet goes back over a hop twice.", (),
               (partial(_returned, known),), refuted_by=TWICE, is_example=True, tell=tell,
               simple=simple),
    ]  # fmt: skip


class Router:
    """A node with a packet in its queue."""

    def __init__(self, known: dict[str, Any]) -> None:
        self.stage = Stage(known, fields.FRAME, 8)
        self.t = self.stage.terms
        self.node = self.stage.record(
            "node", fields.node(SIZE), fields.neighbours(SIZE), fields.tables(SIZE),
            fields.packets(SIZE), fields.queued(1),
        )  # fmt: skip
        self.params = self.stage.record("params", fields.PARAMS)
        for name, value in (("places", SIZE), ("width", SIZE), ("failover", SEARCH)):
            self.stage.fix(self.params, name, value)
        dest = self.t.unknown("node.q_dest[0]", 0, SIZE - 1)
        self.stage.store[self.node, "q_dest", 0] = dest

    def ask(self, store: Store, question: str, *told: Term | int) -> Term:
        """What a function of the node says."""
        _, answer = self.stage.machine.run(question, [self.node, *told], store)
        assert isinstance(answer, Term)
        return answer

    def had(self, store: Store, who: Term) -> Term:
        """The packet was at somebody, by its path."""
        return self.t.as_truth(self.ask(store, "was_at", 0, who))

    def has_failed(self, store: Store, who: Term) -> Term:
        """Somebody failed for the packet."""
        packet = (store[self.node, name, 0] for name in ("q_origin", "q_seq"))
        return self.t.as_truth(self.ask(store, "is_skipped", *packet, who))


def _chosen(known: dict[str, Any]) -> Step:
    """Whom a search asks next."""
    router = Router(known)
    stage = router.stage
    stage.machine = Answers(known, router.t, stage.out, LOOKED_UP)
    t, before = router.t, stage.store
    args = [router.node, router.params, 0]
    after, who = stage.machine.run("choose_by_search", args, before)
    is_one = t.negated(t.same(who, t.number(NOBODY)))
    came = t.same(who, router.ask(before, "giver", 0))
    back = t.any(came, t.same(who, before[router.node, "q_from", 0]))
    goals = [
        Goal("P1 who had the packet is asked only to take it back",
             t.implies(t.all(is_one, router.had(before, who)), back)),
        Goal("P2 nobody is asked who failed for it",
             t.implies(is_one, t.negated(router.has_failed(before, who)))),
    ]  # fmt: skip
    return router.stage.step("the next hop is chosen", after, stage.machine.facts, goals)


def _entered(known: dict[str, Any]) -> Step:
    """A node enters itself into the path of what it transmits."""
    router = Router(known)
    t, before = router.t, router.stage.store
    who = t.unknown("who", 0, 255)
    after, result = router.stage.machine.run("add_hop", [router.node, 0], before)
    done = t.same(t.as_number(result), t.number(1))
    me = before[router.node, "number", None]
    goals = [
        Goal("P3 who transmits a packet is in its path from then on",
             t.implies(done, router.had(after, me))),
        Goal("P4 who was in its path stays there",
             t.implies(router.had(before, who), router.had(after, who))),
    ]  # fmt: skip
    return router.stage.step("a node transmits a packet", after, [], goals)


def _stored(known: dict[str, Any]) -> Step:
    """What is taken over has the path that it came with."""
    router = Router(known)
    t, stage = router.t, router.stage
    frame = stage.record("frame", fields.FRAME)
    who = t.unknown("who", 0, 255)
    before = stage.store
    _, was = stage.machine.run("in_path", [frame, who], before)
    body = t.same(before[frame, "length", None], t.number(0))
    after, _ = stage.machine.run("store", [router.node, 0, frame], before)
    same = t.same(t.as_truth(was), router.had(after, who))
    goal = Goal("P5 the path of what is taken over is that it came with", same)
    return router.stage.step("a node takes a packet over", after, [body], [goal])


def _failed(known: dict[str, Any]) -> Step:
    """A neighbour fails for a packet, and others for others."""
    router = Router(known)
    t, stage, node = router.t, router.stage, router.node
    before = stage.store
    packet = [before[node, name, 0] for name in ("q_origin", "q_seq")]
    who = t.unknown("who", 0, 254)
    other = [t.unknown(f"other.{name}", 0, high) for name, high in (("o", 254), ("s", 65535))]
    then = t.unknown("then", 0, 254)
    once, _ = stage.machine.run("skip", [node, *packet, who], before)
    last, _ = stage.machine.run("skip", [node, *other, then], before)
    place = t.unknown("place", 0, SKIPS - 1)
    kept = []
    for k in range(SKIPS):
        is_next = t.same(before[node, "skip_at", None], t.number(k))
        same = t.all(*(t.same(before[node, name, k], last[node, name, k])
                       for name in ("skip_origin", "skip_seq", "skip_neighbour")))  # fmt: skip
        kept.append(t.implies(t.all(t.same(place, t.number(k)), t.negated(is_next)), same))
    goals = [
        Goal("P6 who failed for a packet is noted", router.has_failed(once, who)),
        Goal("P7 every other failure stays noted but the oldest", t.all(*kept)),
    ]
    return router.stage.step("a neighbour fails for a packet", last, [], goals)


def _returned(known: dict[str, Any]) -> Step:
    """A packet comes back to a node that has passed it on, and once more."""
    stage = Stage(known, fields.FRAME, 8)
    t = stage.terms
    kept = [field for field in fields.packets(SIZE) if field[0].startswith("done_")]
    node, first = stage.record("node", kept), stage.record("first", fields.FRAME)
    second = stage.record("second", fields.FRAME)
    for name in ("kind", "flags", "origin", "seq"):
        stage.store[second, name, None] = stage.store[first, name, None]
    after, results = stage.store, []
    for frame in (first, second):
        after, result = stage.machine.run("record_return", [node, frame], after)
        results.append(t.same(t.as_number(result), t.number(0)))
    facts = [results[0], _passed_on(stage, node, first)]
    goal = Goal(ONCE, t.negated(results[1]))
    return stage.step(TWICE, after, facts, [goal])


def _passed_on(stage: Stage, node: Record, frame: Record) -> Term:
    """A node has the packet at the first place of its cache, with the path that it came with."""
    t, store = stage.terms, stage.store
    kind = cached_kind(stage, frame)
    others = [t.negated(t.same(store[node, "done_origin", k], store[frame, "origin", None]))
              for k in range(1, FORWARDED)]  # fmt: skip
    return t.all(
        t.same(store[node, "done_origin", 0], store[frame, "origin", None]),
        t.same(store[node, "done_seq", 0], store[frame, "seq", None]),
        t.same(store[node, "done_kind", 0], kind),
        t.less(t.number(1), store[node, "done_hops", 0]),
        *others,
    )


def cached_kind(stage: Stage, frame: Record) -> Term:
    """What a cache of packets that were passed on has as a frame's kind: its parity, too."""
    t, store = stage.terms, stage.store
    parity = t.shr(t.bits_and(store[frame, "flags", None], t.number(PARITY)), t.number(1))
    return t.bits_or(store[frame, "kind", None], parity)


def simple(step: Step) -> list[Term]:
    """Short paths and a small number."""
    t = step.terms
    wishes = [(step.was("node", "done_hops", 0), 2), (step.was("first", "path_len"), 3),
              (step.was("second", "path_len"), 4), (step.was("first", "seq"), 1),
              (step.was("first", "origin"), 0)]  # fmt: skip
    return [t.same(value, t.number(number)) for value, number in wishes]


def tell(step: Step, question: Question, _goal: str) -> list[str]:
    """Three nodes and an ack that is lost."""
    seq = question.value(step.was("first", "seq"))
    lengths = [question.value(step.was(name, "path_len")) for name in ("first", "second")]
    return [
        f"A has passed packet {seq} on to B, and B to C. B misses C's acks: C failed.",
        f"B knows nobody else: it gives the packet back to A, with a path of {lengths[0]} nodes. "
        "A takes it back.",
        "C, which has it, too, knows nobody else either: it gives it back to B, which takes it, "
        "and gives it back to A.",
        f"That path has {lengths[1]} nodes, more than the first: A takes it back again. "
        "The packet has gone from B to A twice, as two copies.",
    ]
