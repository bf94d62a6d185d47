"""What was under way at a node that stops has its end: nobody waits for ever."""

import asyncio
import os
import signal
import subprocess
import sys

import pytest

from innervate.live import status
from innervate.live.channel_radio import MediumRadio
from innervate.live.receipts import EXPIRED, HOP_ACKED, REFUSED, STOPPED
from innervate.networks.radio.live.node import RadioNode
from innervate.networks.radio.live.parameters import RADIO
from innervate.networks.radio.live.stack import StationStack
from tests.live.net import Mesh, until

FIRST_S = 30.0
STATION = """
kind = "radio"
number = 0
[[link]]
kind = "medium"
address = "127.0.0.1:9"
"""


async def ends(waiting):
    """What each receipt says that somebody waits for already, once that is told."""
    async with asyncio.timeout(5.0):
        return await asyncio.gather(*waiting)


def waits(receipts):
    return [asyncio.ensure_future(receipt.wait()) for receipt in receipts]


def test_messages_under_way_expire_with_their_sender():
    """With the router, in its backlog, in order, in pieces, acknowledged by a hop and no more."""

    async def main():
        async with Mesh(3, [(0, 1), (1, 2)]) as mesh:
            one = mesh.nodes[0]
            mesh.cut(1, 2)
            receipts = [one.send_message(2, bytes([k]), in_order=k % 2 == 0) for k in range(60)]
            receipts += [one.send_message(2, bytes(2000)) for _ in range(2)]
            await until(lambda: any(receipt.state == HOP_ACKED for receipt in receipts))
            assert one.outgoing.status()["backlog"] > 0
            waiting = waits(receipts)
            changing = asyncio.ensure_future(receipts[-1].change())
            await asyncio.sleep(0)
            await one.stop()
            assert await ends([changing, *waiting]) == 63 * [EXPIRED]
            assert {receipt.reason for receipt in receipts} == {STOPPED}
            assert one.outcomes["messages expired"] == 62
            assert one.outgoing.status() == {"backlog": 0, "waiting": {}, "under_way": 0}
            refused = one.send_message(1, b"late")
            assert (refused.state, refused.reason) == (REFUSED, STOPPED)
            assert await one.drain(1.0)
            mesh.cut(1, 2, cut=False)
            await one.start()  # on again: there is room as at the beginning
            await until(lambda: one.stack.node.version)
            return await ends(waits([one.send_message(2, bytes(2000)), one.send_message(1, b"x")]))

    assert asyncio.run(main()) == ["delivered", "delivered"]


def test_packets_of_a_station_expire_with_it():
    async def main():
        node = RadioNode("s0", StationStack(0, RADIO, 7), MediumRadio(0, ("127.0.0.1", 9)))
        async with node:
            receipts = [node.send_packet(bytes([k])) for k in range(3)]
            waiting = waits(receipts)
            await asyncio.sleep(0)
        assert await ends(waiting) == 3 * [EXPIRED]
        assert {receipt.reason for receipt in receipts} == {STOPPED}
        refused = node.send_packet(b"late")
        assert (refused.state, refused.reason) == (REFUSED, STOPPED)
        return node.outcomes["packets accepted"], node.outcomes["packets expired"]

    assert asyncio.run(main()) == (3, 3)


@pytest.mark.parametrize("words", [["1", "text"], ["1", "text", "--json"]])
def test_who_waits_for_a_message_of_a_process_that_ends_is_told(tmp_path, words):
    (tmp_path / "n0.toml").write_text(STATION)
    env = {**os.environ, "INNERVATE_RUN": str(tmp_path)}
    command = [sys.executable, "-m", "innervate.cli", "live"]
    node = subprocess.Popen(
        [*command, "node", str(tmp_path / "n0.toml")], env=env, stderr=subprocess.PIPE, text=True
    )
    with node:
        try:
            assert "ready" in node.stderr.readline()
            sender = subprocess.Popen(
                [*command, "send", "n0", *words], env=env, stdout=subprocess.PIPE, text=True
            )
            told = [sender.stdout.readline()]
            counters = status.ask_one(tmp_path / "n0.sock", {"do": "status"})["counters"]
            assert counters["packets accepted"] == 1
            node.send_signal(signal.SIGTERM)
            told.append(sender.communicate(timeout=FIRST_S)[0])
        finally:
            node.terminate()
    assert sender.returncode == 1
    if "--json" in words:
        assert told == ['{"state": "accepted", "reason": ""}\n',
                        '{"state": "expired", "reason": "node stopped"}\n']  # fmt: skip
    else:
        assert told == ["accepted\n", "expired: node stopped\n"]
