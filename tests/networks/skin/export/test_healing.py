"""What a capture says of how a skin healed, packet by packet: two cells and both ways to the PC."""

import pytest

from innervate.dialect import plain
from innervate.export import links, pcapng
from innervate.export.reading import Capture
from innervate.networks.skin import frames as skin
from innervate.networks.skin.export.recovery import CUT as LOST
from innervate.networks.skin.export.recovery import END_NS, Healing, line, recoveries
from innervate.networks.skin.protocol import constants, fields

MS = 1_000_000
OUT, IN = pcapng.OUTBOUND, pcapng.INBOUND
# Who is joined with whom: each end is an interface, in this order.
ENDS = [
    ("cell", 0, 1),
    ("pc", -1, 0),
    ("cell", 0, 2),
    ("cell", 1, 3),
    ("cell", 1, 0),
    ("pc", -1, 1),
]
C0_PC, PC_C0, C0_C1, C1_C0, C1_PC, PC_C1 = range(6)


def frame(kind, **words):
    made = plain.make("Frame", fields.FRAME)()
    made.kind = kind
    for name, value in words.items():
        setattr(made, name, value)
    return skin.encode(made)


def beacon(at_ms, end, parent, comment=""):
    data = frame(constants.BEACON, dist=1, parent=parent)
    return pcapng.packet(end, round(at_ms * MS), data, OUT, comment.encode())


def sample(at_ms, end, flags, cell, seq, comment=""):
    data = frame(constants.DATA, cell=cell, seq=seq)
    return pcapng.packet(end, round(at_ms * MS), data, flags, comment.encode())


def event(at_ms, end, what):
    return pcapng.packet(end, round(at_ms * MS), b"", OUT, f"event: {what}".encode())


def healed(tmp_path, *packets):
    blocks = [pcapng.section("innervate, live from three nodes")]
    for number, (what, node, port) in enumerate(ENDS):
        sides = (f"a{number // 2}", f"b{number // 2}")
        there = sides if number % 2 == 0 else sides[::-1]
        blocks.append(pcapng.interface(147, f"{number}", links.describe(what, node, port, there)))
    path = tmp_path / "skin.pcapng"
    path.write_bytes(b"".join([*blocks, *packets]))
    return recoveries(Capture(path))


BEGIN = (beacon(0, C0_PC, 1), beacon(1, C1_PC, 1), beacon(2, C0_C1, 0), beacon(2, C1_C0, 0))
BEFORE = (sample(500, C0_PC, OUT, 0, 7), sample(501, PC_C0, IN, 0, 7))
CUT = (event(1_000, C0_PC, "cut"), event(1_000.5, PC_C0, "cut"))


def test_a_cut_is_followed_until_all_are_heard_by_another_way(tmp_path):
    found = healed(
        tmp_path, *BEGIN, *BEFORE, *CUT,
        sample(1_005, C0_PC, OUT, 0, 8, LOST), beacon(1_010, C0_PC, 1, LOST),
        beacon(1_050, C0_PC, 0, LOST), beacon(1_051, C0_C1, 1),
        sample(1_060, C0_C1, OUT, 0, 9), sample(1_061, C1_PC, OUT, 0, 9),
        sample(1_062, PC_C1, IN, 0, 9), beacon(1_500, C1_PC, 1),
    )  # fmt: skip
    assert found == [Healing(
        at_s=1.0, what="cut c0.1 - pc.0", cells=1, apart=[], watched_ms=500.0, first_ms=51.0,
        wrong_ms=10.0, routed_ms=51.0, heard_ms=62.0, heard_median_ms=62.0, lost=1,
    )]  # fmt: skip
    assert line(found[0]) == (
        "1.000 s: cut c0.1 - pc.0; 1 cell: first moved 51 ms, last wrong parent 10 ms, "
        "all routed 51 ms, all heard 62 ms, half of them heard 62 ms; 1 sample lost"
    )


def test_what_comes_by_the_cut_cable_is_not_the_new_way(tmp_path):
    late = (sample(999, C0_PC, OUT, 0, 8), sample(1_002, PC_C0, IN, 0, 8))
    (one,) = healed(tmp_path, *BEGIN, *BEFORE, late[0], *CUT, late[1], beacon(1_500, C1_PC, 1))
    assert (one.cells, one.heard_ms, one.lost) == (1, None, 0)
    assert (one.first_ms, one.routed_ms, one.watched_ms) == (None, None, 500.0)
    assert "all routed not within 500 ms" in line(one)


def test_both_cables_gone_leave_nobody_a_way(tmp_path):
    found = healed(
        tmp_path, *BEGIN, *CUT, event(2_000, C1_PC, "cut"), event(2_000.5, PC_C1, "cut"),
        event(3_000, PC_C1, "restore"), event(3_000.5, C1_PC, "restore"), beacon(3_100, C1_PC, 1),
    )  # fmt: skip
    assert [(one.what, one.cells, one.apart) for one in found] == [
        ("cut c0.1 - pc.0", 1, []),
        ("cut c1.0 - pc.1", 0, ["c0", "c1"]),
        ("restore c1.0 - pc.1", 2, []),
    ]
    assert [one.watched_ms for one in found] == [1_000.0, 1_000.0, 100.0]
    assert "2 cells cut off, with no cables to the PC left (c0, c1)" in line(found[1])
    assert "no other cell had to find another way" in line(found[1])


def test_a_node_that_goes_takes_those_behind_it(tmp_path):
    behind = (beacon(0, C0_PC, 0), beacon(1, C0_C1, 1), beacon(2, C1_PC, 1))
    gone, back = event(1_000, C1_PC, "node gone"), event(4_000, C1_PC, "node back")
    found = healed(tmp_path, *behind, gone, beacon(1_030, C0_PC, 1), back, beacon(4_500, C0_PC, 1))
    assert [(one.what, one.cells) for one in found] == [("c1 gone", 1), ("c1 back", 1)]
    assert (found[0].routed_ms, found[0].watched_ms) == (30.0, 3_000.0)


@pytest.mark.parametrize(("end_ms", "kept"), [
    (END_NS / MS - 0.001, False), (END_NS / MS, True), (END_NS / MS + 1, True),
])  # fmt: skip
def test_who_goes_at_the_end_was_ended(tmp_path, end_ms, kept):
    gone = event(3_000, C1_PC, "node gone")
    found = healed(tmp_path, *BEGIN, *CUT, gone, beacon(3_000 + end_ms, C0_C1, 0))
    assert [one.what for one in found] == ["cut c0.1 - pc.0"] + ["c1 gone"] * kept


def test_a_skin_that_sends_no_samples_is_not_said_to_be_unheard(tmp_path):
    quiet = healed(tmp_path, *BEGIN, *CUT, beacon(1_050, C0_PC, 0, LOST), beacon(1_060, C1_PC, 1))
    assert not quiet[0].sampled
    assert "heard" not in line(quiet[0])
    assert line(quiet[0]).endswith("; no samples in the capture")
    told = healed(tmp_path, *BEGIN, *BEFORE, *CUT, beacon(1_050, C0_PC, 0, LOST))
    assert told[0].sampled
    assert "all heard not within 50 ms" in line(told[0])
