"""A node of a mesh as somebody else would write one, from docs/wire.md alone.

It imports nothing of ours and is as small as can be: it responds in rounds, keeps its table, hands
on what comes by, and acknowledges. It knows no failures: what is not acknowledged is sent again.
"""

import asyncio
import struct

REQUEST, RESPONSE, TABLE, TABLE_ACK, DATA, END_TO_END_ACK, ACK = 1, 2, 3, 4, 8, 9, 16
ACK_WANTED, ASKS_END_TO_END = 1, 2
ALL, TTL, READING, LOUD_DBM = 255, 48, 2, -40


def crc(data):
    found = 0xFFFF
    for byte in data:
        found ^= byte << 8
        for _ in range(8):
            found = (found << 1 ^ (0x1021 if found & 0x8000 else 0)) & 0xFFFF
    return found


def framed(data):
    return data + struct.pack(">H", crc(data))


class Packet:
    def __init__(self, frame):
        self.kind, self.flags, self.sender, self.receiver, self.origin, self.dest = frame[:6]
        self.kind &= 63
        self.seq, self.table, self.ttl, nodes = struct.unpack(">HBBB", frame[6:11])
        self.path, self.payload = frame[11 : 11 + nodes], frame[11 + nodes : -2]


class Stranger:
    """Node `number`; `ends` are its cables, each with `send` for bytes."""

    def __init__(self, number, ends):
        self.number, self.ends = number, ends
        self.side, self.round, self.uplink, self.gateway = {}, None, None, None
        self.seq, self.version, self.next, self.parts = 100, 0, {}, {}
        self.heard, self.got, self.acked, self.under_way = set(), [], set(), set()

    def take(self, end, frame):
        assert crc(frame[:-2]) == int.from_bytes(frame[-2:], "big")
        if frame[0] & 63 == ACK:
            sender, receiver, origin, seq = struct.unpack(">BBBH", frame[1:6])
            self.side[sender] = end
            if receiver == self.number:
                self.acked.add((sender, origin, seq))
            return
        packet = Packet(frame)
        self.side[packet.sender] = end
        if packet.receiver not in (self.number, ALL):
            return
        if packet.receiver == self.number and packet.flags & ACK_WANTED:
            head = bytes((64 | ACK, self.number, packet.sender, packet.origin))
            end.send(framed(head + struct.pack(">Hb", packet.seq, LOUD_DBM)))
        known = packet.kind, packet.origin, packet.seq, packet.flags & 128
        if known not in self.heard:
            self.heard.add(known)
            self.later(self.act(packet))

    def later(self, action):
        task = asyncio.ensure_future(action)
        self.under_way.add(task)
        task.add_done_callback(self.under_way.discard)

    async def act(self, packet):
        if packet.kind == REQUEST:
            await self.respond(packet)
        elif packet.kind in (RESPONSE, TABLE_ACK):
            await self.pass_on(packet, self.uplink)
        elif packet.kind == TABLE:
            count = packet.payload[0]
            route = packet.payload[1 : 1 + count]
            if route[-1] == self.number:
                await self.keep(packet.payload[1 + count :])
            else:
                await self.pass_on(packet, route[route.index(self.number) + 1])
        elif packet.dest != self.number:
            await self.pass_on(packet, self.next[packet.dest])
        else:
            self.got.append((packet.kind, packet.origin, packet.payload))
            if packet.flags & ASKS_END_TO_END and packet.kind == DATA:
                acked = struct.pack(">H", packet.seq)
                await self.send(END_TO_END_ACK, self.next[packet.origin], packet.origin, acked)

    async def respond(self, packet):
        gateway, epoch, number = struct.unpack(">BBH", packet.payload[:4])
        if gateway == ALL or self.round == (epoch, number):
            return
        self.round, self.uplink, self.gateway = (epoch, number), packet.sender, gateway
        for end in self.ends:
            end.send(self.frame(packet, ALL))
        await asyncio.sleep(0.05)  # whoever is behind us passes it on, too, and is heard
        listed = b"".join(struct.pack(">Bb", node, LOUD_DBM) for node in self.side)
        head = struct.pack(">BHB", epoch, number, READING << 4 | len(self.side))
        await self.send(RESPONSE, self.uplink, gateway, head + listed)

    async def keep(self, part):
        epoch, version, which = struct.unpack(">BHB", part[:4])
        parts = self.parts.setdefault((epoch, version), {})
        parts[which >> 4] = part[4:]
        if len(parts) == which & 15:
            self.version = version
            for groups in parts.values():
                while groups:
                    onward, _, count = groups[:3]
                    self.next |= dict.fromkeys(groups[3 : 3 + count], onward)
                    groups = groups[3 + count :]
        bits = sum(1 << at for at in parts)
        answer = struct.pack(">BHH", epoch, version, bits)
        await self.send(TABLE_ACK, self.uplink, self.gateway, answer)

    async def send(self, kind, to, dest, payload, flags=0):
        self.seq += 1
        head = bytes((64 | kind, flags | ACK_WANTED, self.number, to, self.number, dest))
        table = self.version & 255 if kind > TABLE_ACK else 0
        rest = struct.pack(">HBBB", self.seq, table, TTL, 1) + bytes((self.number,)) + payload
        await self.hop(framed(head + rest), to, (to, self.number, self.seq))

    async def pass_on(self, packet, to):
        await self.hop(self.frame(packet, to), to, (to, packet.origin, packet.seq))

    def frame(self, packet, to):
        """A packet as we send it on: to all as it is, to one with a transmission less left."""
        ttl = packet.ttl - (to != ALL)
        head = bytes((64 | packet.kind, packet.flags, self.number, to, packet.origin, packet.dest))
        path = packet.path + bytes((self.number,))
        counts = struct.pack(">HBBB", packet.seq, packet.table, ttl, len(path))
        return framed(head + counts + path + packet.payload)

    async def hop(self, frame, to, key):
        while key not in self.acked:
            self.side[to].send(frame)
            await asyncio.sleep(0.05)
