"""Wireshark's own dissector of Babel reads what live nodes say."""

import os
import subprocess
import sys

import pytest

from innervate.export import pcapng
from innervate.networks.babel.packets import Packets
from innervate.networks.babel.protocol.constants import INFINITY
from tests.export.tshark_runs import tshark  # noqa: F401 - a fixture
from tests.networks.babel.test_rfc8966_packets import KNOWN, OTHER, coder, frame

INNERVATE = [sys.executable, "-m", "innervate.cli"]
WRONG = "_ws.malformed or _ws.expert or babel.message.type in {11..223, 225..255}"


def test_every_message_is_read(tmp_path, tshark):  # noqa: F811
    head = pcapng.for_dissector(*Packets.wireshark)
    blocks = [pcapng.section(), pcapng.interface(pcapng.UPPER_PDU, "n300")]
    for place, (values, _octets) in enumerate(KNOWN):
        data = head + coder(OTHER).encode(frame(**values))
        blocks.append(pcapng.packet(0, place, data, pcapng.OUTBOUND))
    (tmp_path / "all.pcapng").write_bytes(b"".join(blocks))
    assert tshark(tmp_path / "all.pcapng", "-Y", WRONG) == []
    kinds = tshark(tmp_path / "all.pcapng", "-T", "fields", "-e", "babel.message.type")
    assert kinds == ["7,4", "7,4,5", "7,4,5,6,8", "7,6,8", "7,5", "7,9", "7,10", "7,2", "7,3"]
    told = tshark(tmp_path / "all.pcapng", "-Y", f"babel.message.rxcost == {INFINITY}", "-T",
                  "fields", "-e", "babel.message.prefix", "-e", "babel.message.routerid", "-e",
                  "babel.message.metric", "-e", "babel.message.interval")  # fmt: skip
    assert told == [
        "696e6e657276012c,ffff0003,fd696e6e65727661696e6e6572760003\t696e6e6572760003\t96\t1,3,2"
    ]


@pytest.mark.slow
def test_live_nodes_say_nothing_else(tmp_path, tshark):  # noqa: F811
    changes = ["--set", "nodes=4", "--set", "event=[]"]
    up = [*INNERVATE, "live", "up", "babel-patch", "--for", "8", *changes]
    out = tmp_path / "live.pcapng"
    capture = [*INNERVATE, "live", "capture", "--out", out, "--for", "2"]
    with subprocess.Popen(up, stdout=subprocess.PIPE, text=True) as nodes:
        assert nodes.stdout is not None
        told = [nodes.stdout.readline() for _ in range(3)]
        assert "4 nodes and 4 cables are up" in told[0]
        env = os.environ | {"INNERVATE_RUN": told[2].rpartition("=")[2].strip()}
        subprocess.run(capture, env=env, check=True, timeout=30)
    assert tshark(out, "-Y", f"frame.len > 0 and ({WRONG} or not babel)") == []
    kinds = set(tshark(out, "-T", "fields", "-e", "babel.message.type"))
    assert {"7,4,5", "7,4,5,6,8"} <= kinds
