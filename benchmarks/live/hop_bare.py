"""A node of a line of three that does nothing but what any in Python on asyncio has to do.

One datagram a hop for each message, and one back that ends it: no loss, no order, no way is found.
"""

import asyncio
import socket
from collections import Counter

DATAGRAM_MAX = 2048
NUMBER_BYTES = 4


class Bare:
    """Node 0 sends, 1 passes on, 2 hears and answers; at `ports` of this machine."""

    def __init__(self, number, ports):
        self.name, self.number = f"bare{number}", number
        self.addresses = [("127.0.0.1", port) for port in ports]
        self.sock = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        self.sock.setblocking(False)
        self.sock.bind(self.addresses[number])
        self.waiting, self.next = {}, 0
        self.hear = lambda sender, payload: None

    async def start(self):
        asyncio.get_running_loop().add_reader(self.sock.fileno(), self._readable)

    async def stop(self):
        asyncio.get_running_loop().remove_reader(self.sock.fileno())
        self.sock.close()

    def receive_messages(self, hear):
        self.hear = hear

    def send_message(self, to, payload):
        self.next += 1
        number = self.next.to_bytes(NUMBER_BYTES, "big")
        receipt = self.waiting[number] = Waited()
        self.sock.sendto(number + payload, self.addresses[1])
        return receipt

    def counters(self):
        return Counter()

    def _readable(self):
        while True:
            try:
                data, address = self.sock.recvfrom(DATAGRAM_MAX)
            except BlockingIOError:
                return
            if self.number == 1:
                to = 2 if address == self.addresses[0] else 0
                self.sock.sendto(data, self.addresses[to])
            elif self.number == 2:
                self.hear(0, data[NUMBER_BYTES:])
                self.sock.sendto(data[:NUMBER_BYTES], address)
            else:
                self.waiting.pop(data).end.set_result("delivered")


class Waited:
    """What becomes of a message."""

    def __init__(self):
        self.end = asyncio.get_running_loop().create_future()

    @property
    def state(self):
        return self.end.result() if self.end.done() else "accepted"

    async def wait(self):
        return await self.end
