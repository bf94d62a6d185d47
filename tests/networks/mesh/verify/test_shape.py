"""A node's record as a value: times from the present on, ranges, draws, what no longer matters."""

import random

import pytest

from innervate.dialect import plain
from innervate.dialect.arith import MASK30
from innervate.networks.mesh.protocol import constants as const
from innervate.networks.mesh.protocol import fields
from innervate.networks.mesh.verify import shape

HALF = MASK30 >> 1
NODES = 3

DECLARED = (("tick_at", 0, 0, HALF, "us", ""), ("q_due", 2, 0, HALF, "us", ""),
            ("q_born", 2, 0, HALF, "us", ""), ("small", 0, -2, 5, "x", ""),
            ("many", 3, 1, 300, "x", ""), ("bytes", 2, 0, 255, "x", ""))  # fmt: skip


class Record:
    def __init__(self, **values):
        now = shape.NOW
        vars(self).update(tick_at=now, q_due=[now] * 2, q_born=[now] * 2, small=0)
        vars(self).update(many=[1, 2, 3], bytes=[0, 255])
        vars(self).update(values)


def made(grain=1):
    return shape.Shape(DECLARED, ("tick_at", "q_due", "q_born"), grain)


@pytest.mark.parametrize(("time", "now", "grain", "found"), [
    (50, 20, 1, 30), (50, 20, 7, 28), (20, 50, 1, 0), (20, 20, 1, 0), (3, MASK30 - 4, 1, 8),
    (HALF, 0, 1, HALF), (HALF + 1, 0, 1, 0), (6, 0, 7, 0),
])  # fmt: skip
def test_what_is_to_come_is_kept_in_whole_grains_and_the_past_as_nothing(time, now, grain, found):
    assert shape.ahead(time, now, grain) == found


@pytest.mark.parametrize(("time", "now", "grain", "found"), [
    (20, 50, 1, 30), (20, 50, 7, 28), (50, 50, 1, 0), (MASK30 - 4, 3, 1, 8),
    (0, 4_999_999, 1, 4_999_999), (0, 5_000_000, 1, 5_000_000), (0, 5_000_001, 1, 5_000_000),
])  # fmt: skip
def test_whatever_is_five_seconds_old_is_alike(time, now, grain, found):
    assert shape.age(time, now, grain) == found


def test_times_are_from_the_present_on_and_ages_back_from_it():
    value = made().take(Record(tick_at=1100, q_due=[1000, 900], q_born=[1000, 940]), 1000)
    assert value[:3] == (100, bytes([0, 0]) if isinstance(value[1], bytes) else (0, 0), (0, 60))
    again = Record()
    made().put(again, value)
    assert (again.tick_at, again.q_due) == (shape.NOW + 100, [shape.NOW] * 2)
    assert again.q_born == [shape.NOW, shape.NOW - 60]
    assert (again.small, list(again.many), list(again.bytes)) == (0, [1, 2, 3], [0, 255])
    assert made().take(again, shape.NOW) == value


@pytest.mark.parametrize(("name", "inside", "outside"), [
    ("small", -2, -3), ("small", 5, 6), ("many", [1, 300, 1], [0, 1, 1]),
    ("many", [300, 1, 1], [1, 1, 301]), ("bytes", [255, 0], [256, 0]), ("bytes", [0, 0], [-1, 0]),
])  # fmt: skip
def test_a_field_out_of_its_range_is_told_by_name(name, inside, outside):
    one = made()
    one.take(Record(**{name: inside}), shape.NOW)
    with pytest.raises(shape.OutOfRange, match=f"^{name} = "):
        one.take(Record(**{name: outside}), shape.NOW)


def test_arrays_that_are_alike_are_kept_once():
    one = made()
    a, b = (one.take(Record(), shape.NOW) for _ in range(2))
    assert all(x is y for x, y in zip(a, b, strict=True) if isinstance(x, tuple | bytes))


def node_of(script=()):
    made = plain.make("Node", fields.node(NODES))
    node = shape.drawing(made, lambda number, count: 100 * number + count)()
    node.number, node.script, node.drawn = 2, script, []
    return node


@pytest.mark.parametrize(("count", "script", "answer", "noted"), [
    (8, (3,), 3, [8]), (8, (9,), 7, [8]), (2, (), 0, [2]), (9, (3,), 209, []), (0, (3,), 0, []),
])  # fmt: skip
def test_a_draw_out_of_few_is_answered_by_the_script_and_noted(count, script, answer, noted):
    node = node_of(script)
    node.asked = count
    assert (node.choice, node.drawn) == (answer, noted)


def filled(seed):
    """A node with anything in it, in its ranges."""
    rng, node = random.Random(seed), node_of()
    for name, length, low, high, *_ in fields.node(NODES):
        if name in ("choice", "asked", "number"):
            continue
        draws = [rng.randint(low, min(high, low + 200)) for _ in range(max(length, 1))]
        setattr(node, name, draws if length else draws[0])
    for i in range(fields.QUEUE):
        node.q_state[i] = i % 2
        node.q_length[i], node.q_path_len[i] = i % const.BODY, i % const.PATH_MAX
    for i in range(fields.WAITING):
        node.wait_kind[i], node.wait_length[i] = i % 2, i % const.DATA_MAX
    return node


def part(node, name, i, size):
    return getattr(node, name)[i * size : (i + 1) * size]


@pytest.mark.parametrize("adapts", [0, 1])
@pytest.mark.parametrize("seed", range(3))
def test_what_is_looked_at_no_more_is_put_to_one_value(seed, adapts):
    node, before = filled(seed), filled(seed)
    shape.tidy(node, 4, adapts, shape.NOW)
    assert (node.rng, node.tick_at) == (1, 0)
    assert node.round_trip == (before.round_trip if adapts else 0)
    assert {*node.far, *node.line} == {0}
    for i in range(fields.QUEUE):
        length, hops = before.q_length[i], before.q_path_len[i]
        if before.q_state[i]:
            assert part(node, "q_body", i, const.BODY) == (
                part(before, "q_body", i, const.BODY)[:length] + [0] * (const.BODY - length)
            )
            assert part(node, "q_path", i, const.PATH_MAX) == (
                part(before, "q_path", i, const.PATH_MAX)[:hops] + [0] * (const.PATH_MAX - hops)
            )
            kept = [name for name in shape.QUEUED if name != "q_order"]
            assert all(getattr(node, name)[i] == getattr(before, name)[i] for name in kept)
        else:
            assert {getattr(node, name)[i] for name in shape.QUEUED if name != "q_due"} == {0}
            assert (node.q_due[i], node.q_born[i]) == (shape.NOW, shape.NOW)
            assert not any(
                part(node, "q_body", i, const.BODY) + part(node, "q_path", i, const.PATH_MAX)
            )
    used = [i for i in range(fields.QUEUE) if before.q_state[i]]
    assert sorted(node.q_order[i] for i in used) == list(range(len(used)))
    assert node.q_next == len(used)


@pytest.mark.parametrize("adapts", [0, 1])
def test_packets_that_wait_keep_what_they_need(adapts):
    node, before = filled(5), filled(5)
    shape.tidy(node, 4, adapts, shape.NOW)
    for i in range(fields.WAITING):
        length = before.wait_length[i] if before.wait_kind[i] else 0
        body = part(before, "wait_body", i, const.DATA_MAX)[:length]
        assert part(node, "wait_body", i, const.DATA_MAX) == body + [0] * (const.DATA_MAX - length)
        names = shape.RETRANSMISSION
        kept = [getattr(before, name)[i] if before.wait_kind[i] else 0 for name in names]
        assert [getattr(node, name)[i] for name in names] == kept
        old = before.wait_at[i] if adapts and length else shape.NOW
        assert node.wait_at[i] == old
        assert node.wait_sent[i] == (before.wait_sent[i] if before.wait_kind[i] else shape.NOW)


def test_nobodys_places_and_times_of_who_is_not_suspected_are_empty():
    node = filled(6)
    node.skip_origin[0] = node.bad_neighbour[0] = node.neighbour[0] = const.ALL
    node.skip_origin[1], node.bad_neighbour[1], node.neighbour[1] = 1, 1, 1
    node.suspect[0] = node.suspect[1] = shape.SUSPECT
    node.until[0] = node.until[1] = 77
    node.suspect[2], node.until[2] = 0, 77
    kept = node.skip_seq[1], node.skip_neighbour[1], node.bad_dest[1], node.heard[1]
    shape.tidy(node, 4, 0, shape.NOW)
    assert (node.skip_seq[0], node.skip_neighbour[0], node.bad_dest[0]) == (0, 0, 0)
    assert (node.skip_seq[1], node.skip_neighbour[1], node.bad_dest[1], node.heard[1]) == kept
    assert [getattr(node, name)[0] for name in shape.NEIGHBOUR] == [0] * len(shape.NEIGHBOUR)
    assert (node.until[1], node.until[2]) == (77, 0)


def test_the_order_of_what_was_forwarded_says_nothing_until_one_is_overwritten():
    node = filled(7)
    places = fields.FORWARDED
    node.done_origin[:] = [2, 1, *[const.ALL] * (places - 2)]
    node.done_seq[:2] = [5, 6]
    shape.tidy(node, 4, 0, shape.NOW)
    assert (node.done_at, node.done_origin[:3]) == (2, [1, 2, const.ALL])
    assert (node.done_seq[:2], set(node.done_seq[2:])) == ([6, 5], {0})
    full = filled(7)
    full.done_origin[:] = [1 + k % 2 for k in range(places)]
    before = list(full.done_seq), full.done_at
    shape.tidy(full, 4, 0, shape.NOW)
    assert (full.done_seq, full.done_at) == before
