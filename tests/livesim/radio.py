"""A radio team on a channel that is a process: stations join, send, are killed and come back."""

import asyncio
from collections import Counter

from innervate.live import files
from innervate.live.channel import Medium
from innervate.live.channel_radio import SEND
from innervate.networks.radio.frames import payload_of
from tests.livesim.checks import ITEMS_MOST, items_of
from tests.livesim.host import TERM, Host
from tests.livesim.net import Net
from tests.livesim.world import SECOND, inside

WHERE = "127.0.0.1"
PORT = 5000
AGAIN_S = 30.0  # so long after all is whole everybody is in the round again
ENDS_S = 120.0  # a packet was heard by then, once all is whole


class Plan:
    """What a seed stands for; see mesh.Plan."""

    def __init__(self, world, **given):
        chance = world.chance("plan")
        self.nodes = chance.randint(5, 12)
        self.storms = chance.randint(1, 3)
        self.storm_s = chance.choice((30, 120, 600))
        self.calm_s = chance.choice((0, 600))
        self.every_s = chance.choice((1.0, 5.0, 20.0))
        self.hurts = ("crash", "ended", "unplugged", "clock", "late", "channel")
        for name, value in given.items():
            assert hasattr(self, name), name
            setattr(self, name, value)


class Team:
    """Stations on one machine with their channel, whose clock they share."""

    def __init__(self, world, plan):
        self.world, self.plan = world, plan
        self.chance = world.chance("stage")
        self.net = Net(world)
        self.medium = Host(world, self.net, "medium", [WHERE], "")
        self.medium.main = self._run_medium
        self.hosts = [self._host(k) for k in range(plan.nodes)]
        for host in (self.medium, *self.hosts):
            host.ppm, host.boot_ns = 0.0, SECOND
        self.channel = None
        self.on_air = Counter()  # how often each payload was sent: again where its proof was lost
        self.net.sniffers.append(self._note_sent)
        self.quiet = False
        self.sent = {}
        self.open = {}
        self.count = 0
        self.told = {"delivered": 0, "refused": 0, "sender gone": 0, "handed up": 0}

    def _host(self, number):
        head = {"kind": "radio", "name": f"s{number}", "number": number,
                "socket": f"/run/s{number}.sock", "role": "station"}  # fmt: skip
        links = [{"kind": "medium", "address": f"{WHERE}:{PORT}"}]
        host = Host(self.world, self.net, f"s{number}", [WHERE], files.text(head, {}, links))
        host.number = number
        host.on_begin = lambda life: life.node.receive_packets(
            lambda source, payload: self._heard(number, life, source, payload)
        )
        return host

    async def _run_medium(self):
        self.channel = Medium()
        self.channel.open((WHERE, PORT))
        await asyncio.Event().wait()

    def begin(self):
        """The channel, then the stations; users who send."""
        self.medium.begin()
        for host in self.hosts:
            self.world.after(0.5 + 3 * self.chance.random(), host.begin)
        self.world.after(20.0, self._send_some)
        self.world.after(1.0, self._look)

    def _send_some(self):
        if not self.quiet:
            self.send(self.chance.choice(self.hosts))
        self.world.after(self.chance.expovariate(1 / self.plan.every_s), self._send_some)

    def _note_sent(self, _source, _target, data):
        if data[:1] == b"T":
            self.on_air[payload_of(data[SEND.size :])] += 1

    def send(self, host):
        """A station's user sends a packet to all; its number, 0 = it does not run."""
        life = host.life
        if life is None or life.node.engine is None:
            return 0
        self.count += 1
        payload = self.count.to_bytes(4, "big") + bytes(self.chance.randint(0, 12))
        receipt = inside(life, life.node.send_packet, payload)
        self.sent[self.count] = [host.number, life, receipt, payload, Counter(), self.world.now]
        if receipt.state == "refused":
            self.told["refused"] += 1
        else:
            self.open[self.count] = self.sent[self.count]
        return self.count

    def _heard(self, number, life, source, payload):
        if not life.alive:
            return
        ident = int.from_bytes(payload[:4], "big")
        sent = self.sent.get(ident)
        if sent is None or sent[3] != payload or sent[0] != source:
            self.world.fail(f"{life.name}: from {source} came {payload.hex()}, which nobody sent")
            return
        sent[4][number, life.number] += 1
        if sent[4][number, life.number] > self.on_air[payload]:
            self.world.fail(f"{life.name}: has packet {ident} oftener than it was sent")
        self.told["handed up"] += 1

    def _look(self):
        """What became of those that are under way."""
        for ident, (number, life, receipt, _, handed, at) in list(self.open.items()):
            if receipt.state == "delivered":
                self.told["delivered"] += 1
                if not handed:
                    self.world.fail(f"packet {ident} of s{number} is delivered, nobody has it")
                del self.open[ident]
            elif not life.alive:
                self.told["sender gone"] += 1
                del self.open[ident]
            elif self.quiet and self.world.now - max(at, self.quiet_since) > ENDS_S * SECOND:
                self.world.fail(f"packet {ident} of s{number} has no end")
        self.world.after(1.0, self._look)

    def storm(self, seconds):
        """Hurt it for so long."""
        self.quiet = False
        at_s, every_s = 0.0, self.chance.choice((2.0, 10.0, 40.0))
        while at_s < seconds and self.plan.hurts:
            self.world.after(at_s, self._hurt, self.chance.choice(self.plan.hurts))
            at_s += self.chance.expovariate(1 / every_s)

    def _hurt(self, what):
        host = self.chance.choice(self.hosts)
        back_s = self.chance.uniform(0.1, 8.0)
        if self.quiet:
            return
        if what == "channel":
            self.medium.kill()
            self.world.after(back_s, self.medium.begin)
        elif what == "crash" and host.life is not None:
            host.life.loop.crash_after = self.chance.randint(1, 20)
            self.world.after(back_s, host.begin)
        elif what == "ended":
            host.signal(TERM)
            self.world.after(3.0 + back_s, host.begin)
        elif what == "unplugged":
            self._plug(host, "cut")
            self.world.after(back_s, self._plug, host, "restore")
        elif what == "clock":
            host.wall_ns += self.chance.choice((-3600, 3600)) * SECOND
        elif what == "late":
            host.stall(self.chance.choice((0.001, 0.0025, 0.05, 1.0)))

    def _plug(self, host, what):
        if host.life is not None and host.life.node.engine is not None:
            inside(host.life, host.life.node.change, 0, what)

    def heal(self):
        """All is whole again, and everybody runs."""
        self.quiet, self.quiet_since = True, self.world.now
        self.medium.begin()
        for host in self.hosts:
            if host.life is not None:
                host.life.loop.stalled_until, host.life.loop.crash_after = 0, None
                self._plug(host, "restore")
            host.begin()
            self.world.after(4.0, host.begin)

    def check_reach(self):
        """Everybody's packet is heard by everybody else."""
        began = {host.number: self.send(host) for host in self.hosts}
        self.world.run(30.0)
        for number, ident in began.items():
            if not ident:
                self.world.fail(f"s{number} does not run: {self.hosts[number].said[-2:]}")
                continue
            missing = {k for k in range(self.plan.nodes) if k != number} - {
                who for who, _ in self.sent[ident][4]
            }
            if missing or self.sent[ident][2].state != "delivered":
                self.world.fail(f"s{number} is not heard by {sorted(missing)}")
        for host in self.hosts:
            if host.life is not None and items_of(host.life.node) > ITEMS_MOST:
                self.world.fail(f"{host.name} holds {items_of(host.life.node)} objects")
        self.world.check()
