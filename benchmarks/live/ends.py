"""The two ends of a probed connection: run in their namespaces, told what to do on stdin.

ends.py mesh NODE_FILE, or ends.py udp OWN_ADDRESS. Commands, one a line; each answers with JSON:
  go COUNT TO     a probe every 5 ms; then {"sent": {number: ns}, "states": {state: count}}
  take            {"got": [[number, ns], ...]} since the last take
"""

import asyncio
import contextlib
import json
import socket
import sys
import time
from collections import Counter
from pathlib import Path

PERIOD_S = 0.005
PORT = 4800
SETTLE_S = 30.0  # longer than any message is tried


class Mesh:
    """Probes through send_message."""

    def __init__(self, file):
        from innervate.live.build import build
        from innervate.live.nodefile import load

        self.node = build(load(Path(file)))
        self.got = []
        self.receipts = []

    async def start(self):
        self.node.receive_messages(self._receive)
        await self.node.start()

    def _receive(self, _sender, payload):
        self.got.append((int.from_bytes(payload[:4], "big"), time.monotonic_ns()))

    def send(self, to, payload):
        self.receipts.append(self.node.send_message(int(to), payload))

    async def states(self):
        receipts, self.receipts = self.receipts, []
        tasks = [asyncio.ensure_future(receipt.wait()) for receipt in receipts]
        if tasks:
            await asyncio.wait(tasks, timeout=SETTLE_S)
        return Counter(receipt.state for receipt in receipts)

    def status(self):
        return self.node.status()


class Udp:
    """Probes as plain datagrams; routing is the kernel's."""

    def __init__(self, own):
        self.own = own
        self.got = []

    async def start(self):
        self.sock = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.sock.setblocking(False)
        self.sock.bind((self.own, PORT))
        asyncio.get_running_loop().add_reader(self.sock.fileno(), self._receive)

    def _receive(self):
        payload = self.sock.recv(2048)
        self.got.append((int.from_bytes(payload[:4], "big"), time.monotonic_ns()))

    def send(self, to, payload):
        with contextlib.suppress(OSError):  # no route: this probe is lost
            self.sock.sendto(payload, (to, PORT))

    async def states(self):
        await asyncio.sleep(0.5)
        return {}

    def status(self):
        return {}


async def probe(end, count, to):
    """`count` probes, on time, whatever becomes of them."""
    loop = asyncio.get_running_loop()
    sent = {}
    start = loop.time()
    for number in range(count):
        wait = start + number * PERIOD_S - loop.time()
        if wait > 0:
            await asyncio.sleep(wait)
        sent[number] = time.monotonic_ns()
        end.send(to, number.to_bytes(4, "big") + bytes(12))
    return {"sent": sent, "states": dict(await end.states())}


async def main():
    end = {"mesh": Mesh, "udp": Udp}[sys.argv[1]](sys.argv[2])
    await end.start()
    loop = asyncio.get_running_loop()
    reader = asyncio.StreamReader()
    await loop.connect_read_pipe(lambda: asyncio.StreamReaderProtocol(reader), sys.stdin)
    while line := (await reader.readline()).decode().split():
        if line[0] == "go":
            answer = await probe(end, int(line[1]), line[2])
        elif line[0] == "take":
            answer, end.got = {"got": end.got}, []
        else:
            answer = end.status()
        print(json.dumps(answer), flush=True)


if __name__ == "__main__":
    asyncio.run(main())
