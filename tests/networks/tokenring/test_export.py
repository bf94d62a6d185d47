"""Captures of the ring, and the dissector that Wireshark reads them with."""

import json
import random

import pytest

from innervate.cli import main
from innervate.dialect import plain
from innervate.export import pcapng
from innervate.network import networks
from innervate.wire.frames import Codec
from tests.export.tshark_runs import fields_of, runner
from tests.networks.tokenring import fields, frames

NAMES = ["kind", "token.lap", "token.load"]
FIELDS = [f"innervate.tokenring.{name}" for name in NAMES]
DAMAGE = [f"innervate.tokenring.{name}" for name in ("bad_crc", "malformed")]


def called(*words):
    """A command's exit code."""
    return main([str(word) for word in words])


@pytest.fixture
def tshark(known, tmp_path):
    return runner(tmp_path / "home")


@pytest.fixture
def folder(tmp_path):
    """A run of a ring whose tokens carry loads, and its cable cut for a while."""
    file = tmp_path / "ring.toml"
    cut = '[[event]]\nat_s = 0.1\naction = "{}"\nnode = 2\n'
    file.write_text('kind = "tokenring"\nnodes = 5\nloads = true\nduration_s = 0.2\n'
                    + cut.format("cut") + cut.replace("0.1", "0.15").format("restore"))  # fmt: skip
    assert not called("run", file, "--out", tmp_path / "run", "--no-report")
    return tmp_path / "run"


def test_every_field_is_read_back(tmp_path, tshark):
    codec, draw, made = Codec(frames.LAYOUTS, frames.KIND_BITS), random.Random(5), []
    for lap in (0, 65_535, *(draw.randrange(65_536) for _ in range(8))):
        frame = plain.make("Frame", fields.FRAME)()
        frame.kind, frame.lap, frame.load = 1, lap, [draw.randrange(256) for _ in range(2)]
        made.append(frame)
    blocks = [pcapng.section(), pcapng.interface(networks()["tokenring"].link_type, "ring")]
    blocks += [pcapng.packet(0, at, codec.encode(frame), 0) for at, frame in enumerate(made)]
    damaged = bytearray(codec.encode(made[0]))
    damaged[1] ^= 4
    blocks.append(pcapng.packet(0, 99, bytes(damaged), 0))
    path = tmp_path / "ring.pcapng"
    path.write_bytes(b"".join(blocks))
    *found, last = fields_of(tshark, path, [*FIELDS, *DAMAGE])
    wanted = [["1"], *([str(f.lap)] for f in made)]
    assert [one[FIELDS[0]] for one in found] == [["1"]] * len(made)
    assert [one[FIELDS[1]] for one in found] == wanted[1:]
    assert [one[FIELDS[2]] for one in found] == [list(map(str, f.load)) for f in made]
    assert not any(name in one for one in found for name in DAMAGE)
    assert DAMAGE[0] in last


def test_a_run_is_captured_as_its_summary_counts_it(folder, tmp_path, tshark):
    path = tmp_path / "run.pcapng"
    assert not called("export", folder, "--pcapng", path)
    summary = json.loads((folder / "summary.json").read_text())["frames"]
    found = fields_of(tshark, path, [*FIELDS, "frame.interface_name"])
    assert len(found) == summary["sent"] + summary["arrived"] > 100
    assert {one["frame.interface_name"][0] for one in found} == {
        f"n{node} {port}" for node in range(5) for port in "EW"
    }
    laps = [int(one[FIELDS[1]][0]) for one in found]
    assert laps == sorted(laps)
    assert {tuple(one[FIELDS[2]]) for one in found} == {(str(node), "7") for node in range(5)}


def test_its_graph_its_tables_and_a_recording_are_written(folder, tmp_path):
    graph = tmp_path / "ring.json"
    words = (
        "--graph",
        graph,
        "--tables",
        tmp_path / "t",
        "--csv",
        "--mcap",
        tmp_path / "ring.mcap",
    )
    assert not called("export", folder, *words)
    edges = json.loads(graph.read_text())["edges"]
    assert len(edges) == 5
    assert {port for edge in edges for port in (edge["port_a"], edge["port_b"])} == {"E", "W"}
    assert {path.name for path in (tmp_path / "t").iterdir()} == {"deliveries.csv", "reports.csv"}
    assert (tmp_path / "ring.mcap").stat().st_size > 1000
