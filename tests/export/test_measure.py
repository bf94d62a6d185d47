"""Measuring captures that do not say what was lost, and captures that are damaged."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from innervate.dialect import plain
from innervate.export import fitting, links, measure, pcapng
from innervate.export.errors import ExportError
from innervate.networks.mesh import frames as mesh
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
    assert found.beacon_us == pytest.approx(20_000, rel=0.3)
    assert found.rate_hz == pytest.approx(20 / found.seconds, rel=0.01)
    text = fitting.scenario_of(found, "cable")
    assert "hop_latency_us = [150, 150]" in text


def test_on_the_air_a_frame_sent_again_is_the_newest(tmp_path):
    frame = plain.make("Frame", mesh_fields.FRAME)()
    frame.kind, frame.link_src, frame.link_dst = mesh_const.ACK, 4, 7
    data = mesh.encode(frame)
    blocks = [pcapng.section("innervate, live")]
    blocks += [pcapng.interface(148, f"n{i}", f"node {i}") for i in (4, 7, 9)]
    for at in (0, 5 * MS):
        blocks.append(pcapng.packet(0, at, data, pcapng.OUTBOUND))
    blocks += [pcapng.packet(i, 5 * MS + 700_000, data, pcapng.INBOUND) for i in (1, 2)]
    found = measured(tmp_path, blocks)
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
