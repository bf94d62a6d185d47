"""A mesh of live nodes, its users, and what is done to it."""

from innervate.live import files
from tests.livesim.checks import ITEMS_MOST, Messages, Nonces, items_of
from tests.livesim.host import HUP, TERM, Host
from tests.livesim.net import Net, changed
from tests.livesim.world import SECOND, inside

PORT = 4700
AGAIN_S = 45.0  # so long after all is whole again everybody reaches everybody
ENDS_S = 60.0  # a message has its end, if its sender lives
ALL = 255
GRACE_S = 2.0


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
        self.old_lives = False  # what a process received is played back to those after it, too
        for name, value in given.items():
            assert hasattr(self, name), name
            setattr(self, name, value)
        self.links = given.get("links") or links(chance, self.nodes)


def links(chance, count):
    """A connected graph: a tree, and as many links again as make detours."""
    found = set()
    for b in range(1, count):
        found.add((chance.randrange(max(0, b - 4), b), b))
    for _ in range(count):
        a, b = sorted(chance.sample(range(count), 2))
        found.add((a, b))
    return sorted(found)


class Stage:
    """Machines with nodes on them, joined as a plan says; users who send and receive."""

    def __init__(self, world, plan):
        self.world, self.plan = world, plan
        self.chance = world.chance("stage")
        self.net = Net(world)
        self.nonces = Nonces(world)
        self.net.sniffers.append(self.nonces)
        self.messages = Messages(world, ENDS_S)
        self.cables = {}
        self.ends = [[] for _ in range(plan.nodes)]
        for k, pair in enumerate(plan.links):
            here, there = f"10.{k // 200}.{k % 200}.1", f"10.{k // 200}.{k % 200}.2"
            self.cables[pair] = self.net.way(here, there, delay_us=plan.delay_us)
            self.ends[pair[0]].append((here, there))
            self.ends[pair[1]].append((there, here))
        self.key_number = 1
        self.keys = {1: self._secret()}
        self.hosts = [self._host(i) for i in range(plan.nodes)]
        self.places = {}
        self.is_sending = False
        self.lowest = {}

    def _secret(self):
        return self.chance.randbytes(32).hex()

    def _host(self, number):
        addresses = [here for here, _ in self.ends[number]]
        host = Host(self.world, self.net, f"n{number}", addresses, self.file(number))
        host.number = number
        host.on_begin = lambda life: self._listen(number, life)
        for address in addresses:
            self.nonces.keys[address] = lambda key, host=host: self._key_of(host, key)
        return host

    def _key_of(self, host, number):
        return host.life, host.life.node.sealer.keys[number]

    def file(self, number):
        """The text of a node's file, with the keys as they are now."""
        plan, standbys = self.plan, range(1, 1 + self.plan.standbys)
        head = {"kind": "mesh", "name": f"n{number}", "number": number, "nodes": plan.nodes}
        head["socket"] = f"/run/n{number}.sock"
        head["role"] = "gateway" if number == 0 else "standby" if number in standbys else "node"
        if number in standbys:
            head["rank"] = number
        tables = {"protocol": {}, "deliver": {"in_order": plan.in_order}}
        if plan.sealed:
            tables["keys"] = {"use": self.key_number, "grace_s": GRACE_S}
            tables["keys.secret"] = {str(k): text for k, text in self.keys.items()}
        cables = [
            {"kind": "udp", "bind": f"{here}:{PORT}", "peers": [f"{there}:{PORT}"]}
            for here, there in self.ends[number]
        ]
        return files.text(head, tables, cables)

    def _listen(self, number, life):
        in_order = self.plan.in_order

        def take(sender, payload):
            self.messages.handed_up(number, life, sender, payload, in_order)

        life.node.receive_messages(take, in_order=in_order)

    def begin(self):
        """Start all nodes, in any order, within a second."""
        for host in self.hosts:
            self.world.after(self.chance.random(), host.begin)
        self.world.after(0.2, self._look)
        self.world.after(1.0, self._send_some)

    def _look(self):
        self.messages.look()
        self.world.after(0.2, self._look)

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
        sent = self.messages.new(host.number, life, dest, self.chance.randint(5, 88))
        sent.priority = priority
        sent.in_order = self.plan.in_order and dest != ALL
        key = (host.number, life.number, dest, priority)
        sent.place = self.places[key] = self.places.get(key, 0) + 1
        self.messages.sent[sent.ident] = sent  # it may be there before we know
        receipt = inside(life, lambda: life.node.send_message(
            dest, sent.payload, priority=priority, in_order=sent.in_order))  # fmt: skip
        sent.receipt = receipt if dest != ALL else None
        self.messages.accepted(sent)
        return sent

    def rotate(self):
        """Another key in every file, under another number, and a signal to everybody."""
        if not self.plan.sealed:
            return
        self.key_number = self.key_number % 15 + 1
        self.keys = {self.key_number: self._secret()}
        for host in self.hosts:
            wait_s = self.chance.uniform(0, GRACE_S / 3)
            self.world.after(wait_s, self._reload, host, self.file(host.number))

    def _reload(self, host, text):
        host.disk.put(host.path, text)
        host.signal(HUP)

    def replay(self):
        """Somebody sends again what was recorded, as it was, changed, or with nonsense in it."""
        if not self.net.recorded:
            return
        source, target, data, life = self.chance.choice(self.net.recorded)
        if self.plan.old_lives or life.alive:
            self._play_back(source, target, data)

    def _play_back(self, source, target, data):
        what = self.chance.random()
        if what < 0.3:
            data = changed(self.chance, data)
        elif what < 0.4:
            data = self.chance.randbytes(self.chance.randint(0, 200))
        self.net.inject(source, target, data)

    def heal(self):
        """All is whole again, and everybody runs."""
        for ways in self.cables.values():
            for way in ways:
                way.heal()
        for host in self.hosts:
            host.disk.full = False
            host.disk.cut_after = None
            if host.life is not None:
                host.life.loop.stalled_until = 0
                host.life.loop.crash_after = None
            host.begin()
            self.world.after(4.0, host.begin)  # who was told to end may still be at it
        self.messages.quiet_since = self.world.now

    def everybody_reaches_everybody(self):
        """Messages between all, or many, pairs: what was sent."""
        for host in self.hosts:
            if host.life is None:
                self.world.fail(f"{host.name} does not run: {host.said[-3:]} {host.how}")
        self.world.check()
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

    def check_memory(self):
        """No node holds more than it may, or more than when it was first left alone."""
        for host in self.hosts:
            if host.life is not None:
                count = items_of(host.life.node)
                if count > ITEMS_MOST:
                    self.world.fail(f"{host.life.name} holds {count} objects")

    def end(self):
        """Everybody is told to stop, and does."""
        for host in self.hosts:
            host.signal(TERM)
        self.world.run(4.0)
        for host in self.hosts:
            if host.life is not None:
                self.world.fail(f"{host.life.name} does not end")
