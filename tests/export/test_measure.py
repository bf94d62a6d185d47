"""Measuring captures that do not say what was lost, and captures that are damaged."""

import tomllib
from collections import deque

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from innervate.dialect import plain
from innervate.export import fitting, links, measure, pcapng
from innervate.export.errors import ExportError
from innervate.export.measure import Way
from innervate.networks.mesh import frames as mesh
from innervate.networks.mesh.export.fit import Mesh
from innervate.networks.mesh.protocol import constants as mesh_const
from innervate.networks.mesh.protocol import fields as mesh_fields
from innervate.networks.skin import frames as skin
from innervate.networks.skin.protocol import constants as skin_const
from innervate.networks.skin.protocol import fields as skin_fields

MS = 1_000_000


def beacon(dist=3):
    frame = plain.make("Frame", skin_fields.FRAME)()
    frame.kind, frame.dist = skin_const.BEACON, dist
    return skin.encode(frame)


def sample(seq, cell=0):
    frame = plain.make("Frame", skin_fields.FRAME)()
    frame.kind, frame.seq, frame.cell = skin_const.DATA, seq, cell
    return skin.encode(frame)


def cable(lost, frames):
    """A live cable from cell 0 to the PC: all frames leave, those in `lost` never come in."""
    blocks = [
        pcapng.section("innervate, live from two nodes"),
        pcapng.interface(147, "c0", links.describe("cell", 0, 1, ("here", "there"))),
        pcapng.interface(147, "pc", links.describe("pc", -1, 0, ("there", "here"))),
    ]
    for i, data in enumerate(frames):
        at = 20 * MS * i
        blocks.append(pcapng.packet(0, at, data, pcapng.OUTBOUND))
        if i not in lost:
            blocks.append(pcapng.packet(1, at + 150_000, data, pcapng.INBOUND))
    blocks.append(pcapng.packet(1, 20 * MS * len(frames) + 3000 * MS, beacon(0), pcapng.OUTBOUND))
    return blocks


def measured(tmp_path, blocks):
    path = tmp_path / "some.pcapng"
    path.write_bytes(b"".join(blocks))
    return measure.measure(path)


@pytest.mark.parametrize("lost", [set(), {0}, {7, 8, 31}, {40, 55, 56, 57, 99}])
def test_what_is_lost_on_a_live_cable_is_counted_though_beacons_are_alike(lost, tmp_path):
    frames = [sample(i % 256) if i % 5 == 0 else beacon() for i in range(100)]
    found = measured(tmp_path, cable(lost, frames))
    way = found.ways["c0.1", "pc.0"]
    assert (way.got, way.lost) == (100 - len(lost), len(lost))
    assert set(way.delays_us) == {150.0}
    assert found.beacon_us == 20_000
    assert found.rate_hz == pytest.approx(20 / found.seconds, rel=0.01)
    text = fitting.scenario_of(found, "cable")
    assert "hop_latency_us = [150, 150]" in text


S = 1000 * MS
OUT, IN = pcapng.OUTBOUND, pcapng.INBOUND
HERE, THERE = ("c0.1", "pc.0"), ("pc.0", "c0.1")  # the ways of such a cable


def moments(*packets, comment="innervate, live from two nodes"):
    """The same cable; packets are (interface, time in ns, data, out or in, comment)."""
    head = cable(set(), [])[1:3]
    made = [
        pcapng.packet(number, at, data, flags, *(text.encode() for text in more))
        for number, at, data, flags, *more in packets
    ]
    return [pcapng.section(comment), *head, *made]


def ways_of(tmp_path, *packets, **keys):
    """(got, lost, delays) by way."""
    found = measured(tmp_path, moments(*packets, **keys))
    return {key: (way.got, way.lost, list(way.delays_us)) for key, way in found.ways.items()}


@pytest.mark.parametrize(
    ("wait_ns", "got"), [(S - 1, (1, 0, [999_999.999])), (S, (1, 0, [1e6])), (S + 1, (1, 1, []))]
)
def test_a_frame_is_waited_for_a_second(tmp_path, wait_ns, got):
    packets = [(0, 5 * MS, sample(1), OUT), (1, 5 * MS + wait_ns, sample(1), IN)]
    assert ways_of(tmp_path, *packets) == {HERE: got}


@pytest.mark.parametrize(("behind_ns", "lost"), [(S - 1, 0), (S, 0), (S + 1, 1)])
def test_what_may_still_come_in_when_the_capture_ends_is_not_lost(tmp_path, behind_ns, lost):
    last = 9 * MS + behind_ns
    packets = [(0, 5 * MS, sample(1), OUT), (1, 6 * MS, sample(1), IN),
               (0, 9 * MS, sample(2), OUT), (1, last, sample(3), OUT)]  # fmt: skip
    assert ways_of(tmp_path, *packets)[HERE] == (1, lost, [1000.0])


def test_nothing_comes_in_before_it_has_left(tmp_path):
    # Two nodes write a capture: what they hand over at one moment may stand in it out of order.
    packets = [(0, 5 * MS, sample(7), OUT), (1, 4 * MS, sample(7), IN), (1, 8 * MS, sample(7), IN)]
    assert ways_of(tmp_path, *packets) == {HERE: (2, 0, [3000.0])}


def test_what_comes_in_as_it_leaves_took_no_time(tmp_path):
    packets = [(0, 5 * MS, sample(7), OUT), (1, 5 * MS, sample(7), IN)]
    assert ways_of(tmp_path, *packets) == {HERE: (1, 0, [0.0])}


def test_equal_frames_come_in_as_they_left_and_each_once(tmp_path):
    packets = [(0, MS, sample(7), OUT), (0, 2 * MS, sample(7), OUT), (1, 4 * MS, sample(7), IN),
               (1, 7 * MS, sample(7), IN), (1, 8 * MS, sample(7), IN)]  # fmt: skip
    assert ways_of(tmp_path, *packets) == {HERE: (3, 0, [3000.0, 5000.0])}


def test_each_way_of_a_cable_is_measured_by_itself(tmp_path):
    packets = [(0, MS, sample(7), OUT), (1, 2 * MS, sample(7), OUT), (1, 3 * MS, sample(7), IN),
               (0, 6 * MS, sample(7), IN)]  # fmt: skip
    assert ways_of(tmp_path, *packets) == {
        HERE: (1, 0, [2000.0]), THERE: (1, 0, [4000.0])}  # fmt: skip


@pytest.mark.parametrize(("comment", "lost", "delays"), [
    ("innervate, live from two nodes", 1, [3000.0]),  # what was before it on its path is lost
    ("innervate skin x, seed 1, simulated", 0, [3000.0, 8000.0]),  # ... unless its loss is told
])  # fmt: skip
def test_a_path_keeps_the_order_of_frames(tmp_path, comment, lost, delays):
    packets = [(0, MS, sample(1), OUT), (0, 2 * MS, sample(2), OUT), (0, 3 * MS, sample(3), OUT),
               (1, 5 * MS, sample(2), IN), (1, 9 * MS, sample(1), IN)]  # fmt: skip
    assert ways_of(tmp_path, *packets, comment=comment) == {HERE: (2, lost, delays)}


def test_a_capture_is_as_long_as_from_its_first_packet_to_its_last(tmp_path):
    packets = [(0, 5 * S, sample(1), OUT), (1, 5 * S + MS, sample(1), IN),
               (0, 7 * S, sample(2), OUT)]  # fmt: skip
    blocks = moments(*packets)
    found = measured(tmp_path, blocks)
    assert (found.seconds, found.packets, found.notes) == (2.0, 3, [])
    assert list(found.ways[HERE].sizes) == [len(sample(1))]
    found = measured(tmp_path, [*blocks, blocks[-1][:-5]])
    assert (found.seconds, found.packets) == (2.0, 3)
    assert found.notes == ["the capture ends in the middle of a block"]


def mesh_of(*ways, seconds=30.0):
    """A measured mesh; a way is (from, to, share of 100 frames that came in, delay in us)."""
    found = Mesh("mesh", seconds=seconds)
    for a, b, got, *delay_us in ways:
        found.ways[a, b] = Way(got, 100 - got, deque(delay_us), deque([20] * len(delay_us)))
    return found


@pytest.mark.parametrize(("seconds", "duration"), [(0.5, 2.0), (2.0, 2.0), (2.0625, 2.062),
                                                   (60.0, 60.0), (60.5, 60.0)])  # fmt: skip
def test_a_scenario_lasts_as_long_as_its_capture_within_bounds(seconds, duration):
    text = fitting.scenario_of(mesh_of((0, 1, 100), (1, 0, 100), seconds=seconds), "some")
    assert tomllib.loads(text)["duration_s"] == duration


BOTH = "links, each way: {} captured, {} simulated, {} in both"
CHECKED = [
    ([(0, 1, 90), (1, 0, 50)], True, [BOTH.format(2, 2, 2),
                                      "quality: apart by 0.1000 on average, 0.2000 at most"]),
    ([(0, 1, 90), (1, 0, 70), (2, 0, 10)], False, [
        BOTH.format(2, 3, 2), "  simulated only: n2 to n0",
        "quality: apart by 0.0000 on average, 0.0000 at most"]),
    ([(0, 1, 90), (1, 0, 70), (2, 0, 9)], True, [
        BOTH.format(2, 3, 2),
        "  not named, as less than 10 % of their frames came in: 0 captured only, 1 simulated only",
        "quality: apart by 0.0000 on average, 0.0000 at most"]),
    ([(0, 1, 90), (1, 0, 0)], False, [
        BOTH.format(2, 1, 1), "  captured only: n1 to n0",
        "quality: apart by 0.0000 on average, 0.0000 at most"]),
    ([(2, 0, 90)], False, [
        BOTH.format(2, 1, 0), "  captured only: n0 to n1, n1 to n0", "  simulated only: n2 to n0"]),
    ([(0, 1, 90, 7.0), (1, 0, 70, 9.0)], True, [
        BOTH.format(2, 2, 2), "quality: apart by 0.0000 on average, 0.0000 at most",
        "delay, simulated: 7 to 9 us, median 8 us"]),
]  # fmt: skip


@pytest.mark.parametrize(("again", "same", "said"), CHECKED)
def test_what_is_said_of_a_fitted_scenario(monkeypatch, again, same, said):
    """Captured: n0 to n1 90 %, back 70 %. What its simulation gives is put in its place."""
    found = mesh_of((0, 1, 90), (1, 0, 70))
    text = fitting.scenario_of(mesh_of((0, 1, 90), (1, 0, 70), (2, 0, 90), (0, 2, 90)), "some")
    monkeypatch.setattr(fitting.capture, "write", lambda plan, path: None)
    monkeypatch.setattr(fitting, "measure", lambda path: mesh_of(*again))
    assert fitting.check(text, found) == (said, same)


NEVER_SENT = ["queue full", "port found broken", "switched off"]


@pytest.mark.parametrize(
    ("why", "lost", "cut"),
    [("noise", 1, set()), ("cable cut", 0, {"c0.1"}), *((why, 0, set()) for why in NEVER_SENT)],
)
def test_a_simulations_capture_says_what_became_of_each_frame(tmp_path, why, lost, cut):
    blocks = moments(
        (0, MS, sample(1), OUT, measure.DROPPED + why), (0, 2 * MS, sample(2), OUT),
        (0, 3 * MS, sample(3), OUT), (1, 4 * MS, sample(3), IN),
        (1, 5 * MS, sample(2), IN, measure.DROPPED + "switched off"), (1, 3 * S, sample(9), OUT),
        comment="innervate skin s, seed 1, simulated",
    )  # fmt: skip
    found = measured(tmp_path, blocks)
    way = found.ways[HERE]
    # Of its path's frames, 2 came in at a node that was off: it is no loss of the cable's.
    assert (way.got, way.lost, list(way.delays_us)) == (1, lost, [1000.0])
    assert found.cut == cut


def test_beacons_of_a_port_and_samples_of_a_cell_give_their_rates(tmp_path):
    packets = []
    for k in range(6):
        packets.append((0, 4 * MS * k, beacon(), OUT))
        packets.append((1, 4 * MS * k + 10, beacon(1), OUT))
    for k in range(5):  # of which cell 3 measured two: they only pass by
        packets.append((0, (21 + k) * MS, sample(k, cell=3 * (k < 2)), OUT))
        packets.append((1, (21 + k) * MS + 500, sample(k, cell=3 * (k < 2)), IN))
    found = measured(tmp_path, moments(*packets))
    assert found.beacon_us == 4000.0
    assert found.seconds == pytest.approx(0.0250005)
    assert found.rate_hz == pytest.approx(3 / found.seconds)


def heard_on_air(*moments_):
    """A frame from node 4 to node 7 in a live capture: (interface, us, out or in)."""
    frame = plain.make("Frame", mesh_fields.FRAME)()
    frame.kind, frame.link_src, frame.link_dst = mesh_const.ACK, 4, 7
    blocks = [pcapng.section("innervate, live")]
    blocks += [pcapng.interface(148, f"n{i}", f"node {i}") for i in (4, 7, 9)]
    data = mesh.encode(frame)
    return blocks + [
        pcapng.packet(number, 1000 * at, data, flags) for number, at, flags in moments_
    ]


def test_on_the_air_nothing_is_heard_before_it_is_sent(tmp_path):
    found = measured(
        tmp_path, heard_on_air((0, 0, OUT), (0, 5000, OUT), (1, 700, IN), (2, 5900, IN))
    )
    assert {key: list(way.delays_us) for key, way in found.ways.items()} == {
        (4, 7): [700.0], (4, 9): [900.0],
    }  # fmt: skip


def test_on_the_air_a_frame_sent_again_is_the_newest(tmp_path):
    sent = [(0, 0, OUT), (0, 5000, OUT)]
    found = measured(tmp_path, heard_on_air(*sent, (1, 5700, IN), (2, 5700, IN)))
    assert {key: list(way.delays_us) for key, way in found.ways.items()} == {
        (4, 7): [700.0], (4, 9): [700.0],
    }  # fmt: skip


def test_a_network_that_no_scenario_has_is_told(tmp_path):
    blocks = cable(set(), [sample(1)])
    blocks[2] = pcapng.interface(147, "pc", links.describe("pc", -1, 5, ("there", "here")))
    found = measured(tmp_path, blocks)
    with pytest.raises(ExportError, match="no scenario has a network") as told:
        fitting.scenario_of(found, "cable")
    assert "\n" not in str(told.value)


@settings(deadline=None, max_examples=30)
@given(st.data())
def test_any_damage_gives_a_network_or_one_line(tmp_path_factory, data):
    mixed = bytearray(b"".join(cable({3}, [sample(1), beacon(), sample(2), beacon()])))
    for _ in range(data.draw(st.integers(1, 6))):
        mixed[data.draw(st.integers(0, len(mixed) - 1))] = data.draw(st.integers(0, 255))
    path = tmp_path_factory.getbasetemp() / "damaged.pcapng"
    path.write_bytes(mixed)
    said = ""
    try:
        fitting.scenario_of(measure.measure(path), "damaged")
    except ExportError as error:
        said = str(error)
    assert "\n" not in said
