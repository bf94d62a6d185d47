"""What the proofs of a mesh's caches speak of, of a node whose values are known."""

import pytest

from innervate.dialect.arith import MASK16
from innervate.networks.mesh.protocol.constants import PARITY
from innervate.networks.mesh.protocol.duplicates import BITS
from innervate.networks.mesh.protocol.fields import FORWARDED, WINDOW_WORDS
from innervate.networks.mesh.prove import hops, theories
from innervate.networks.mesh.prove.theories import ORIGIN, REACH, Window
from innervate.prove.steps import Stage


def is_so(term):
    assert term.op == "const", term
    return bool(term.low)


def window_of(behind, noted=(), idle=1, newest=0):
    """A window whose newest is so far ahead of what it was; the packet is so far behind that."""
    made = Window({})
    t, store = made.t, made.stage.store
    store[made.node, "newest", ORIGIN] = made.number(t.number(newest))
    made.seq = made.number(t.number((newest - behind) & MASK16))
    store[made.node, "idle", ORIGIN] = t.number(idle)
    for word in range(WINDOW_WORDS):
        bits = sum(1 << (k - 1) % BITS for k in noted if (k - 1) // BITS == word)
        store[made.node, "window", ORIGIN * WINDOW_WORDS + word] = t.number(bits)
    return made, store


@pytest.mark.parametrize(("behind", "noted", "is_noted"), [
    (0, (), True), (1, (1,), True), (1, (2,), False), (1, (), False), (BITS, (BITS,), True),
    (BITS + 1, (BITS + 1,), True), (BITS + 1, (BITS,), False), (REACH, (REACH,), True),
    (REACH, (), False), (REACH + 1, (), True),
])  # fmt: skip
def test_a_packet_is_noted_by_its_bit_within_reach(behind, noted, is_noted):
    for newest in (0, 7):
        made, store = window_of(behind, noted, newest=newest)
        assert made.behind(store).value == behind
        assert is_so(made.is_noted(store)) == is_noted


@pytest.mark.parametrize(("idle", "is_open"), [(0, False), (1, True), (9, True)])
def test_a_window_is_open_until_it_is_idle_for_long(idle, is_open):
    made, store = window_of(1, idle=idle)
    assert is_so(made.is_open(store)) == is_open
    assert [is_so(one) for one in made.state()] == [is_open, False]


def test_reach_is_as_many_numbers_as_bits():
    assert REACH == BITS * WINDOW_WORDS == 75


NOTED = {"done_origin": 3, "done_seq": 9, "done_kind": 5}


def cache_of(frame, **changes):
    """A cache that has (3, 9) of kind 5 at its place 2, and a frame."""
    stage, node, made, kind = theories._cache({})
    values = {"origin": 3, "seq": 9, "kind": 5, "flags": 0} | frame
    for name, value in values.items():
        stage.store[made, name, None] = stage.terms.number(value)
    for k in range(FORWARDED):
        for name, value in (NOTED | changes).items():
            stage.store[node, name, k] = stage.terms.number(value if k == 2 else 0)
    return stage, node, made, kind


@pytest.mark.parametrize(("frame", "changes", "is_it"), [
    ({}, {}, True), ({}, {"done_kind": 5 | 64}, True), ({"origin": 4}, {}, False),
    ({"seq": 8}, {}, False), ({"kind": 4}, {}, False), ({}, {"done_kind": 6}, False),
])  # fmt: skip
def test_a_place_holds_a_packet_of_either_parity(frame, changes, is_it):
    stage, node, made, _ = cache_of(frame, **changes)
    found = [is_so(theories._is_it(stage, node, made, stage.store, k)) for k in (1, 2)]
    assert found == [False, is_it]


def test_a_frames_kind_there_has_its_parity():
    stage, _, frame, kind = theories._cache({})
    assert kind.op == "or"
    assert PARITY >> 1 == 64
    assert repr(kind) == "or(frame.kind, shr(and(frame.flags, 128), 1))"
    assert stage.store[frame, "kind", None] is kind.args[0]


def test_a_router_has_as_many_neighbours_and_recipients_as_stand_for_all():
    router = hops.Router({})
    assert isinstance(router.stage, Stage)
    fixed = [router.stage.store[router.params, name, None].value for name in ("places", "width")]
    assert fixed == [hops.SIZE] * 2
