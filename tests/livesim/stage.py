"""Machines with live nodes on them, joined by cables; what all kinds of networks share."""

from tests.livesim.checks import ITEMS_MOST, items_of, takes_once
from tests.livesim.host import HUP, TERM, Host
from tests.livesim.net import Net, Way, changed

PORT = 4700
GRACE_S = 2.0
GROUP = "239.1.1.1"


class Stage:
    """Machines with nodes on them, joined as a plan says. Subclasses know files and users.

    Args:
        world: whose time it is.
        plan: with `nodes`, `links`, `sealed`, `delay_us`, `old_lives`.

    Attributes:
        cables: both ways of every cable, by its pair of nodes.
        ends: for each node, (own address, the other's) of its cables.
    """

    def __init__(self, world, plan):
        self.world, self.plan = world, plan
        self.chance = world.chance("stage")
        self.net = Net(world)
        self.storm, self.quiet_since, self.rotated_at = 0, None, None
        self.cables = {}
        self.ends = [[] for _ in range(plan.nodes)]
        if getattr(plan, "multicast", False):
            self._join_all()
        else:
            self._join_pairs()
        self.key_number = 1
        self.keys = {1: self._secret()}
        self.hosts = [self._host(i) for i in range(plan.nodes)]

    def _join_pairs(self):
        """A cable for each link, with two addresses of its own."""
        for k, pair in enumerate(self.plan.links):
            here, there = f"10.{k // 200}.{k % 200}.1", f"10.{k // 200}.{k % 200}.2"
            self.cables[pair] = self.net.way(here, there, delay_us=self.plan.delay_us)
            self.ends[pair[0]].append((here, there))
            self.ends[pair[1]].append((there, here))

    def _join_all(self):
        """One network for all, as a radio channel: who sends to the group hears itself, too."""
        own = [f"10.0.0.{k + 1}" for k in range(self.plan.nodes)]
        for a, b in self.plan.links:
            self.cables[a, b] = self.net.way(own[a], own[b], delay_us=self.plan.delay_us)
        for ends, here in zip(self.ends, own, strict=True):
            self.net.ways[here, here] = Way()
            ends.append((here, GROUP))

    def file(self, number):
        """The text of a node's file, with the keys as they are now."""
        raise NotImplementedError

    def listen(self, number, life):
        """A process begins: its users listen."""

    def key_tables(self):
        """The [keys] of a file."""
        if not self.plan.sealed:
            return {}
        return {"keys": {"use": self.key_number, "grace_s": GRACE_S},
                "keys.secret": {str(k): text for k, text in self.keys.items()}}  # fmt: skip

    def links(self, number):
        """The [[link]]s of a file."""
        if getattr(self.plan, "multicast", False):
            here, group = self.ends[number][0]
            return [{"kind": "multicast", "group": f"{group}:{PORT}", "interface": here}]
        return [
            {"kind": "udp", "bind": f"{here}:{PORT}", "peers": [f"{there}:{PORT}"]}
            for here, there in self.ends[number]
        ]

    def begin(self):
        """Start all nodes, in any order, within a second."""
        for host in self.hosts:
            self.world.after(self.chance.random(), host.begin)

    def _secret(self):
        return self.chance.randbytes(32).hex()

    def name(self, number):
        """What a node is called."""
        return f"n{number}"

    def _host(self, number):
        addresses = [here for here, _ in self.ends[number]]
        host = Host(self.world, self.net, self.name(number), addresses, self.file(number))
        host.number = number
        host.on_begin = lambda life: self._begun(number, life)
        return host

    def _begun(self, number, life):
        takes_once(self.world, self.net.taken, life)
        self.listen(number, life)

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
        self.quiet_since = self.world.now

    def check_running(self):
        """Everybody runs."""
        for host in self.hosts:
            if host.life is None:
                self.world.fail(f"{host.name} does not run: {host.said[-3:]} {host.how}")
        self.world.check()

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
        self.world.check()
