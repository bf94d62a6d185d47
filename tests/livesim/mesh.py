"""A mesh of live nodes, its users, and what is done to it."""

from collections import Counter
from itertools import combinations
from types import SimpleNamespace

from innervate.live import files
from innervate.live.receipts import DELIVERED, FINAL
from innervate.networks.mesh.live.parameters import IP
from innervate.networks.mesh.protocol.timeout import lifetime
from tests.livesim.checks import Messages
from tests.livesim.host import TERM
from tests.livesim.slowly import Slowly
from tests.livesim.stage import GRACE_S, Stage
from tests.livesim.world import SECOND, PowerCut, inside

AGAIN_S = 15.0  # so long, and these ticks, after all is whole everybody reaches everybody
AGAIN_TICKS = 120
ENDS_S = 60.0  # a message has its end, if its sender lives
GONE_LIVES = 8 / 7  # a message to a node that is not there has its end: an eighth, and some
TICK_US = 250_000
TRIED_S = 26.25
ALL = 255
PIECES_MOST = 16 * 65_536  # bytes of messages that a node puts together
PIECES_EACH = 2  # of a sender


class Plan:
    """What a seed stands for; a test may set what it wants.

    Attributes:
        nodes: how many.
        links: pairs of them.
        sealed: frames are sealed.
        in_order: messages are sent and received in order.
        hurts: names of what may be done to it, see `hurts.py`.
        storms: how often it is hurt and then left alone.
        storm_s: how long each time.
        rate: messages a second, of all nodes.
        long: share of messages that are longer than a frame.
        in_c: every so many-th node runs its protocol as C; 0 = none does.
        slow: by how much its ticks are longer than usual.
        near_ends: counters have nearly gone round when it begins.
        held_up: now and then a process is stopped for long.
        longer_s: so much longer than usual a message may be tried, as its recipient remembers.
    """

    def __init__(self, world, **given):
        chance = world.chance("plan")
        self.nodes = chance.choice((5, 6, 7, 8, 10, 12, 16, 30))
        self.sealed = chance.random() < 0.7
        self.in_order = chance.random() < 0.6
        self.hurts = None
        self.storms = chance.randint(1, 3)
        self.storm_s = chance.choice((20, 60, 120))
        self.calm_s = chance.choice((0, 60, 600))
        self.rate = chance.choice((1, 5, 20)) if self.nodes < 16 else 2
        self.delay_us = chance.choice(((50, 150), (100, 400), (300, 900)))
        self.standbys = chance.randint(0, 2)
        self.multicast = self.nodes <= 8 and chance.random() < 0.2  # all hear all
        longer = world.chance("long")
        self.mtu = longer.choice((127, 127, 1200))
        self.long = longer.choice((0.0, 0.05, 0.3))
        self.in_c = 0
        self.slow = 1
        self.near_ends = False
        self.held_up = world.chance("long stops").random() < 0.15
        if self.held_up:
            self.storm_s = 300
        self.old_lives = False  # what a process received is played back to those after it, too
        for name, value in given.items():
            assert hasattr(self, name), name
            setattr(self, name, value)
        tried = SimpleNamespace(forget=IP["forget"], tick_us=TICK_US * self.slow)
        self.longer_s = max(0.0, lifetime(tried) / 1e6 - TRIED_S)
        self.links = links(chance, self.nodes)
        if self.multicast:
            self.links = list(combinations(range(self.nodes), 2))


class Weeks(Plan):
    """A mesh with beacons 5 to 15 s apart, as on batteries: hours of hurts, then hours of calm."""

    def __init__(self, world, **given):
        chance = world.chance("weeks")
        slow = {
            "nodes": chance.choice((5, 6, 8)),
            "slow": chance.choice((20, 40, 60)),
            "sealed": chance.random() < 0.5,
            "storm_s": 3600 * chance.choice((1, 6)),
            "calm_s": 3600 * chance.choice((6, 24, 72)),
            "rate": chance.choice((0.005, 0.02, 0.1)),
            "standbys": chance.randint(0, 2),
            "multicast": chance.random() < 0.05,
            "near_ends": world.chance("ends").random() < 0.5,
        }
        super().__init__(world, **slow | given)


def links(chance, count):
    """A connected graph: a tree, and as many links again as make detours."""
    found = set()
    for b in range(1, count):
        found.add((chance.randrange(max(0, b - 4), b), b))
    for _ in range(count):
        a, b = sorted(chance.sample(range(count), 2))
        found.add((a, b))
    return sorted(found)


class Mesh(Stage):
    """A mesh, and users who send and receive."""

    def __init__(self, world, plan):
        super().__init__(world, plan)
        self.messages = Messages(self, ENDS_S + plan.longer_s)
        self.look_s = 0.2 * plan.slow
        self.places = {}
        self.is_sending = False
        self.lengths = world.chance("lengths")
        self.slowly = Slowly(self) if plan.slow > 1 else None

    def file(self, number):
        """The text of a node's file, with the keys as they are now."""
        plan, standbys = self.plan, range(1, 1 + self.plan.standbys)
        head = {"kind": "mesh", "name": f"n{number}", "number": number, "nodes": plan.nodes}
        head["socket"] = f"/run/n{number}.sock"
        head["role"] = "gateway" if number == 0 else "standby" if number in standbys else "node"
        if number in standbys:
            head["rank"] = number
        if plan.in_c and number % plan.in_c == 0:
            head["engine"] = "c"
        protocol = {"mtu": plan.mtu, "tick_us": TICK_US * plan.slow}
        tables = {"protocol": protocol, "deliver": {"in_order": plan.in_order}}
        return files.text(head, tables | self.key_tables(), self.links(number))

    def listen(self, number, life):
        """What comes in is looked at."""
        in_order = self.plan.in_order

        def take(sender, payload):
            self.messages.handed_up(number, life, sender, payload, in_order)

        life.node.receive_messages(take, in_order=in_order)
        if self.slowly:
            self.slowly.listen(life)

    def begin(self):
        """Start all nodes, and users who send."""
        if self.plan.near_ends:
            self.slowly.near_ends()
        super().begin()
        self.world.after(self.look_s, self._look)
        self.world.after(1.0, self._send_some)

    def _look(self):
        self.messages.look()
        for host in self.hosts:
            if host.life is not None:
                self._look_at_pieces(host.life)
        self.messages.forget()
        if self.slowly:
            self.slowly.look()
        self.world.after(self.look_s, self._look)

    def _look_at_pieces(self, life):
        """What a node puts together is bounded, for each sender and in all."""
        names = Counter()
        held = life.node.inbox.pieces._open
        names.update(sender for sender, *_ in held)
        size = sum(len(one.data) for one in held.values())
        if size > PIECES_MOST or max(names.values(), default=0) > PIECES_EACH:
            self.world.fail(f"{life.name} holds {size} bytes in pieces, of {dict(names)}")

    def _length(self, dest):
        """Bytes of a message: now and then more than fit into a frame."""
        if dest == ALL or self.lengths.random() >= self.plan.long:
            return self.chance.randint(5, 88)
        most = self.lengths.choice((200, 1000, 1000, 5000, 5000, 65_536))
        return self.lengths.randint(90, min(most, 10 * self.plan.mtu * self.plan.mtu // 127))

    def _send_some(self):
        """Users send as they like, while they may."""
        if self.is_sending:
            sender = self.chance.choice(self.hosts)
            others = [k for k in range(self.plan.nodes) if k != sender.number]
            dest = self.chance.choice(others)
            if self.chance.random() < 0.03:
                dest = ALL
            for _ in range(self.chance.choice((1, 1, 1, 3, 10))):
                self.send(sender, dest, self.chance.random() < 0.1)
        self.world.after(self.chance.expovariate(self.plan.rate / 2.5), self._send_some)

    def send(self, host, dest, priority=False):
        """A user of a node sends a message; what was sent, None = the node does not run."""
        life = host.life
        if life is None or life.node.engine is None:
            return None
        sent = self.messages.new(host.number, life, dest, self._length(dest))
        sent.priority = priority
        sent.in_order = self.plan.in_order and dest != ALL
        key = (host.number, life.number, dest, priority)
        sent.place = self.places[key] = self.places.get(key, 0) + 1
        self.messages.sent[sent.ident] = sent  # it may be there before we know
        try:
            receipt = inside(life, lambda: life.node.send_message(
                dest, sent.payload, priority=priority, in_order=sent.in_order))  # fmt: skip
        except PowerCut:  # while the node noted its numbers: nobody is there to be told
            return None
        sent.receipt = receipt if dest != ALL else None
        self.messages.accepted(sent)
        return sent

    def again_s(self):
        """How long after all is whole everybody reaches everybody."""
        return AGAIN_S + AGAIN_TICKS * self.plan.slow * TICK_US / 1e6

    def everybody_reaches_everybody(self):
        """Messages between all, or many, pairs: what was sent."""
        self.check_running()
        pairs = [(a, b) for a in self.hosts for b in range(self.plan.nodes) if a.number != b]
        if len(pairs) > 90:
            pairs = self.chance.sample(pairs, 90)
        return [self.send(a, b) for a, b in pairs]

    def check_reach(self, sent):
        """All of these were delivered by now."""
        for one in sent:
            if one.receipt.state != "delivered":
                self.world.fail(
                    f"{one.life.name} does not reach {one.dest}: {one.receipt!r} "
                    f"after {(self.world.now - one.at) / SECOND:.1f} s"
                )

    def check_rest(self):
        """Left alone, no node has anything under way, and all accept the key in use alone."""
        for host in self.hosts:
            if host.life is None:
                continue
            told = host.life.node.status()
            left = {name: told[name] for name in ("backlog", "under_way", "out_of_turn")}
            left |= told["in_pieces"]
            if any(left.values()):
                self.world.fail(f"{host.life.name} still has {left}")
            if self.plan.sealed and told["keys"]["accepted"] != [self.key_number]:
                self.world.fail(f"{host.life.name} accepts {told['keys']}")

    def rotate_in_peace(self):
        """Keys change while messages go, and nobody is shut out."""
        before = self._shut_out()
        self.rotate()
        for k in range(8):
            self.world.after(k * GRACE_S / 3, self._some)
        self.world.run(3 * GRACE_S)
        if self._shut_out() != before:
            self.world.fail(f"frames under an unknown key: {self._shut_out() - before}")
        self.world.check()

    def _some(self):
        sender, dest = self.chance.sample(self.hosts, 2)
        self.send(sender, dest.number)

    def _shut_out(self):
        return sum(host.life.node.counters()["dropped: sealed: unknown key"]
                   for host in self.hosts if host.life is not None)  # fmt: skip

    def leave(self):
        """A node goes, and who sends to it is told."""
        running = [host for host in self.hosts if host.life is not None]
        gone, *others = self.chance.sample(running, 4)
        gone.kill()
        sent = [self.send(host, gone.number) for host in others]
        self.world.run(GONE_LIVES * (TRIED_S + self.plan.longer_s))
        for one in sent:
            if one.receipt.state not in FINAL:
                self.world.fail(f"message {one.ident} to a node that is gone has no end")
        if self.slowly:
            self.slowly.gone()
        self.world.check()

    def drain(self):
        """Who is told to end first gets rid of what is under way."""
        host, other = self.chance.sample(self.hosts, 2)
        sent = [self.send(host, other.number) for _ in range(5)]
        host.signal(TERM)
        self.world.run(3.0)
        for one in sent:
            if one.receipt.state != DELIVERED:
                self.world.fail(f"{host.name} ended before message {one.ident} was delivered")
        self.world.check()

    def end(self):
        """One is told to stop, one goes, then all are told."""
        self.drain()
        self.leave()
        super().end()
