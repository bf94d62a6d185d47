"""Captures of runs: tshark, python-pcapng and the simulator's counters say the same."""

from collections import Counter

import pcapng as others
import pytest
from pcapng.blocks import EnhancedPacket

from innervate import scenario
from innervate.dialect import plain
from innervate.export import capture, links, pcapng
from innervate.export.errors import ExportError
from innervate.export.reading import Capture
from innervate.network import networks
from innervate.networks.mesh import frames as mesh
from innervate.networks.radio import frames as radio
from innervate.networks.skin import frames as skin
from innervate.networks.skin.protocol import fields as skin_fields
from innervate.sim.cables import wires
from tests.export.tshark_runs import fields_of, tshark
from tests.networks.skin.runs import patch

__all__ = ["tshark"]
SKIN = patch(
    3, 4, (0, 1), (3, 1),
    seed=5, duration_s=0.1, data={"rate_hz": 3000, "queue": 2}, timing={"loss": 0.02},
    event=[{"at_s": 0.04, "action": "cut", "interface": 1},
           {"at_s": 0.06, "action": "kill", "cell": {"patch": 0, "row": 1, "column": 1}}],
)  # fmt: skip
MESH = {"kind": "mesh", "duration_s": 12, "nodes": 9, "seed": 2}
RADIO = {"kind": "radio", "duration_s": 2, "stations": 5, "seed": 3,
         "traffic": {"kind": "disaster"}, "channel": {"level": "event"}}  # fmt: skip


def plan_of(keys):
    return scenario.plan(scenario.from_dict(keys))


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """Captures by kind: (file, what was written)."""
    folder = tmp_path_factory.mktemp("captures")
    found = {}
    for keys in (SKIN, MESH, RADIO):
        path = folder / f"{keys['kind']}.pcapng"
        found[keys["kind"]] = (path, capture.write(plan_of(keys), path))
    return found


def tallied(path):
    """How many packets left, came in, and were dropped why, as our own reader finds them."""
    counts = Counter()
    for packet in Capture(path).packets():
        counts["sent" if packet.flags & 3 == 2 else "in"] += 1
        counts[packet.comment] += 1
    return counts


def test_a_skins_capture_counts_what_the_simulator_counted(made, tshark):
    path, written = made["skin"]
    counters = written.result.counters
    counts = tallied(path)
    both = [counters[i] + counters[i + wires.URGENT_BLOCK] for i in range(wires.URGENT_BLOCK)]
    waiting = sum(int(buffer["queued"]) for buffer in written.result.world.buffers)
    assert counts["sent"] == both[wires.SENT] - waiting
    assert counts[""] + sum(counts[w] for w in counts if w.startswith("dropped")) == written.frames
    received = counts["in"] - counts["dropped: switched off"]
    for why, counter in (("noise", wires.LOST_NOISE), ("queue full", wires.LOST_QUEUE),
                         ("cable cut", wires.LOST_CUT), ("switched off", wires.LOST_OFF),
                         ("port found broken", wires.LOST_BROKEN)):  # fmt: skip
        assert counts[f"dropped: {why}"] == both[counter], why
        assert both[counter] > 0 or why == "port found broken", why
    assert written.received == both[wires.ARRIVED]
    assert received >= both[wires.ARRIVED]
    names = ["frame.interface_name", "frame.packet_flags_direction", "frame.comment"]
    found = fields_of(tshark, path, [*names, "innervate.skin.malformed", "innervate.skin.bad_crc"])
    directions = Counter(fields["frame.packet_flags_direction"][0] for fields in found)
    assert directions == {"0x00000002": counts["sent"], "0x00000001": counts["in"]}
    told = Counter(fields["frame.comment"][0] for fields in found if "frame.comment" in fields)
    assert told == {why: count for why, count in counts.items() if why.startswith("dropped")}
    assert all(len(fields) <= 3 for fields in found)  # nothing is damaged
    graph = plan_of(SKIN).graph
    assert {fields["frame.interface_name"][0] for fields in found} <= {
        graph.label_end(end) for end in range(len(graph.peer))
    }


@pytest.mark.parametrize("kind", ["mesh", "radio"])
def test_captures_of_the_air_count_what_the_simulator_counted(kind, made, tshark):
    path, written = made[kind]
    counts, counters = tallied(path), written.result.counts
    got = "arrived" if kind == "mesh" else "decoded"
    assert written.sent == counts["sent"] == len(written.result.sent)
    assert written.received == counters[got] > 0
    lost = sum(count for why, count in counts.items() if why.startswith("dropped"))
    assert counts["in"] == counters[got] + lost
    named = {"mesh": "innervate.mesh.kind", "radio": "frame.len"}[kind]
    found = fields_of(tshark, path, [named, f"innervate.{kind}.malformed"], "-Y",
                      "frame.packet_flags_direction == 2")  # fmt: skip
    assert len(found) == counts["sent"]
    assert not any(f"innervate.{kind}.malformed" in fields for fields in found)
    if kind == "mesh":
        told = Counter(int(fields[named][0]) for fields in found)
        assert told == Counter(written.result.sent["kind"].tolist())


def test_an_independent_reader_agrees(made):
    path, written = made["mesh"]
    with path.open("rb") as file:
        found = [one for one in others.FileScanner(file) if isinstance(one, EnhancedPacket)]
    mine = list(Capture(path).packets())
    assert len(found) == len(mine) == written.frames
    for theirs, own in zip(found, mine, strict=True):
        assert theirs.packet_data == own.data
        assert (theirs.timestamp_high << 32) + theirs.timestamp_low == own.time_ns
        assert theirs.interface_id == own.interface
        assert theirs.options.get("opt_comment", "") == own.comment


@pytest.mark.parametrize("kind", ["skin", "mesh", "radio"])
def test_captures_are_in_order_of_time_and_their_frames_whole(kind, made):
    path, _written = made[kind]
    capture_read = Capture(path)
    packets = list(capture_read.packets())
    times = [packet.time_ns for packet in packets]
    assert times == sorted(times)
    assert {one.link_type for one in capture_read.interfaces} == {networks()[kind].link_type}
    wire = {"skin": skin, "mesh": mesh, "radio": radio}[kind]
    if kind == "skin":
        frame = plain.make("Frame", skin_fields.FRAME)()
        assert {wire.decode(packet.data, frame) for packet in packets} == {wire.OK}
    else:
        assert {wire.reason_of(packet.data) for packet in packets} == {wire.OK}


def test_every_frame_of_a_cable_comes_out_at_its_other_end(made):
    path, _written = made["skin"]
    read = Capture(path)
    left, came = Counter(), Counter()
    for packet in read.packets():
        here = links.place_of(read.interfaces[packet.interface].description)
        if packet.flags & 2 and not packet.comment:
            left[here.here, here.there, packet.data] += 1
        elif packet.flags & 1:
            came[here.there, here.here, packet.data] += 1
    assert not came - left
    assert sum((left - came).values()) < 30  # on their way at the end


def test_what_came_in_unreadable_is_marked_so_and_nothing_else(made):
    words = ("noise", "collision, or not heard from its start", "broken off or garbled")
    seen = Counter()
    for path, _ in made.values():
        for packet in Capture(path).packets():
            is_marked = bool(packet.flags & pcapng.CRC_ERROR)
            is_in = packet.flags & 3 == pcapng.INBOUND
            assert is_in or packet.flags & 3 == pcapng.OUTBOUND
            assert is_marked == (is_in and packet.comment.removeprefix("dropped: ") in words)
            seen[is_marked] += 1
    assert min(seen[True], seen[False]) > 0


def test_a_window_holds_what_happened_in_it(made, tmp_path):
    whole = [p for p in Capture(made["skin"][0]).packets() if 50e6 <= p.time_ns < 60e6]
    part = capture.write(plan_of(SKIN), tmp_path / "part", window_us=(50_000, 60_000))
    assert list(Capture(tmp_path / "part").packets()) == whole
    assert part.frames == len(whole) > 100


def test_a_capture_is_of_the_run_that_it_says(made, tmp_path):
    plan, same = plan_of(SKIN), made["skin"][1].result.fingerprint
    capture.write(plan, tmp_path / "a", fingerprint=same, window_us=(0, 1))
    with pytest.raises(ExportError, match="run it again"):
        capture.write(plan, tmp_path / "b", fingerprint="0" * 16)
    assert not (tmp_path / "b").exists()


@pytest.mark.parametrize(
    ("name", "sets", "why"),
    [("loop-three", [], "script"), ("radio-disaster", ["channel.level=slotted"], "slotted level")],
)
def test_what_has_no_frames_is_told(name, sets, why, tmp_path):
    with pytest.raises(ExportError, match=why):
        capture.write(scenario.plan(scenario.load(name, sets)), tmp_path / "none")
