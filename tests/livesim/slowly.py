"""What only long quiet and slow beacons show: sessions, tables, files and what is remembered."""

import json

from innervate.dialect.arith import MASK16
from innervate.live.contact import OLD_US, SESSIONS, SILENT_US
from innervate.live.engine import clock_us
from innervate.live.session import COUNTERS, REKEY_US
from innervate.networks.mesh.live.node import FEW, NUMBERS
from innervate.wire import seal
from tests.livesim.world import SECOND, inside

LOOK_US = 12_000_000  # a contact at rest looks at its sessions every 10 s
MET_S = 10.0  # all is whole: so soon all neighbours have a session
ASKED_US = 2_000_000  # who asks does so every 1.25 s at least
HANDSHAKES = 2  # on a path, with each renewal: both may begin one
GONE_TICKS = 130  # nodes are gone: so soon nobody knows them, no table has them, no session is left
TICK_S = 0.25
TICKS_END, EPOCHS_END = 65_536, 256
USES_LEFT = 12  # of a session, where very much was sealed in it
FIRST = range(seal.FIRST, 256)


class Slowly:
    """Looks at the nodes of a mesh that is slow.

    Args:
        stage: the mesh, not yet begun.
    """

    def __init__(self, stage):
        self.stage, self.world = stage, stage.world
        self._asked = {}  # (from, to): when a first message left, ns
        self._begun = {}  # by life, when it was first left alone: handshakes begun, frames held
        self.chance = self.world.chance("slowly")
        self._used = 0  # sessions in which very much was sealed
        self._rests = False  # nobody sends a message
        stage.net.sniffers.append(self._sniff)

    def _sniff(self, source, target, data):
        if data[0] in FIRST:
            self._asked[source[0], target[0]] = self.world.now

    def near_ends(self):
        """All begin with counters that have nearly gone round."""
        for host in self.stage.hosts:
            kept = {"epoch": EPOCHS_END - 2, "numbers": TICKS_END - 200, "revoked": ""}
            host.disk.put(host.state_path(), json.dumps(kept))

    def listen(self, life):
        """A process begins: its ticks and rounds come round while it runs."""
        stack, left = life.node.stack, self.chance.randrange(1, 600)
        on_start = stack.on_start

        def begun(now, cause):
            on_start(now, cause)
            stack.node.ticks = TICKS_END - left
            if not stack.node.leading:
                stack.node.round = TICKS_END - left // 8

        if self.stage.plan.near_ends:
            stack.on_start = begun

    def _use_up(self, life):
        """Very much was sealed in a session, all of a sudden."""
        contact = self.chance.choice(list(life.node.sealer._contacts.values()))
        if contact._current is not None and not contact.path.is_group:
            contact._current.counter = max(contact._current.counter, COUNTERS - USES_LEFT)
            self._used += 1

    def look(self):
        """Now, whatever is done to it."""
        is_sealed = self.stage.plan.near_ends and self.stage.plan.sealed
        if is_sealed and self._rests and self.chance.random() < 0.03:
            self._use_up(self.chance.choice(self._lives()))
        for life in self._lives():
            self._look_at_numbers(life)
            if life.node.sealer is not None:
                inside(life, self._look_at_contacts, life)

    def _lives(self):
        hosts = [host for host in self.stage.hosts if host.life is not None]
        return [host.life for host in hosts
                if host.life.node.engine is not None and not host.life.node.is_stopped
                and host.life.loop.stalled_until <= self.world.now]  # fmt: skip

    def _look_at_numbers(self, life):
        """The file's numbers are ahead of those in use, where the disk could keep them."""
        host, state = life.host, life.node.state
        file = host.disk.names.get(str(host.state_path()))
        if file is None or host.disk.full or state.trouble:
            return
        kept, seq = json.loads(file.text), life.node.stack.node.seq
        left = (kept["numbers"] - seq) & MASK16
        if life.node._ahead >= 0 and not 0 < left <= max(NUMBERS, FEW):
            self.world.fail(f"{life.name}: uses {seq}, and its file says {kept['numbers']}")
        if kept["epoch"] != state.epoch:
            self.world.fail(f"{life.name}: epoch {state.epoch}, in its file {kept['epoch']}")

    def _look_at_contacts(self, life):
        """Sessions are as young, as few and as soon made anew as they are to be."""
        now, ring = clock_us(), life.node.sealer.ring
        for contact in life.node.sealer._contacts.values():
            for session in contact._by_index.values():
                if now - session.made_at > OLD_US + LOOK_US:
                    self._fail(life, f"has a session of {(now - session.made_at) / 1e6:.0f} s")
                if session.who.key not in ring.keys:
                    self._fail(life, f"has a session of key {session.who.key}, which is gone")
            if any(len(several) > SESSIONS for several in contact.sessions.values()):
                self._fail(life, f"has more than {SESSIONS} sessions with a neighbour")
            if not contact.path.is_group:
                self._look_at_silence(life, contact, now)

    def _look_at_silence(self, life, contact, now):
        """Who sends and hears nothing asks whether anybody is there."""
        silent_us = now - contact._sent_at if contact._sent_at else 0
        ends = contact.path.link.bind[0], contact.path.address[0]
        asked_us = (self.world.now - self._asked.get(ends, 0)) / 1000
        awake_us = (self.world.now - max(life.loop.stalled_until, life.began)) / 1000
        if min(silent_us, awake_us) > SILENT_US + ASKED_US and asked_us > ASKED_US:
            self._fail(life, f"hears nothing for {silent_us / 1e6:.0f} s, and does not ask")

    def met(self):
        """All is whole for a while: neighbours have sessions; how many handshakes they had."""
        for life in self._lives():
            if life.node.sealer is None:
                continue
            for contact in life.node.sealer._contacts.values():
                if not contact.sessions:
                    self._fail(life, f"has no session on {contact.path.name}")
            self._begun[life] = self.world.now, self._counts(life)
        self._used = 0

    def rested(self, seconds):
        """Left alone since they met, without a message for so long: nothing waited, or is kept."""
        self._rests = False
        self._look_at_windows(seconds)
        for life in self._lives():
            if life not in self._begun:
                continue
            since, (begun, held) = self._begun[life]
            now_begun, now_held = self._counts(life)
            if now_held > held:
                self._fail(life, f"held {now_held - held} frames, for it had no session")
            renewals = 2 + self._used + (self.world.now - since) / SECOND * 1e6 / REKEY_US
            most = HANDSHAKES * renewals * len(life.node.paths)
            if now_begun - begun > most and not self.stage.plan.multicast:
                self._fail(life, f"began {now_begun - begun} handshakes, more than {most:.0f}")
            inside(life, self._look_at_age, life)
        self._begun = {}

    def _look_at_age(self, life):
        now = clock_us()
        for contact in life.node.sealer._contacts.values():
            used = contact.all_sessions() if contact.path.is_group else [contact._current]
            for session in filter(None, used):
                if now - session.made_at > REKEY_US * 6 // 5 + LOOK_US:
                    age_s = (now - session.made_at) / 1e6
                    self._fail(life, f"still uses a session of {age_s:.0f} s")

    def _counts(self, life):
        counts = life.node.sealer.counts
        return counts["handshakes begun"], counts["held: no session yet"]

    def heard(self):
        """Everybody has just had a message of everybody, and knows it again."""
        self._rests = True
        for life, node, other in self._pairs():
            if not node.idle[other]:
                self._fail(life, f"has forgotten what it had of n{other}")

    def _look_at_windows(self, seconds):
        """What was had so long ago is forgotten."""
        for life, node, other in self._pairs():
            params = life.node.stack.params
            ticks = seconds * 1e6 / params.tick_us
            if ticks > params.forget + 2 and node.idle[other]:
                self._fail(life, f"still knows what it had of n{other} {ticks:.0f} ticks ago")

    def _pairs(self):
        for life in self._lives():
            for other in range(self.stage.plan.nodes):
                if other != life.host.number:
                    yield life, life.node.stack.node, other

    def gone(self):
        """Some went: let time pass; nobody has them as neighbours then, or a way to them."""
        self.world.run(GONE_TICKS * self.stage.plan.slow * TICK_S)
        gone = {host.number for host in self.stage.hosts if host.life is None}
        led = self._reached_from(self._leaders(), gone)
        for life in self._lives():
            told = inside(life, life.node.status)
            still = gone & {row["node"] for row in told["neighbours"]}
            if still:
                self._fail(life, f"has {still}, who are gone, as neighbours")
            if life.host.number not in led:  # nobody sends there, and no table changes
                continue
            still = {str(number) for number in gone} & told["routes"].keys()
            if still:
                self._fail(life, f"has ways to {still}, who are gone: {told['routes']}")
            if not self.stage.plan.multicast:
                self._look_at_paths(life, told, gone)

    def _leaders(self):
        return {life.host.number for life in self._lives() if life.node.stack.node.leading}

    def _reached_from(self, numbers, gone):
        """Whoever is joined with one of these by nodes that are there."""
        found, links = set(numbers), self.stage.plan.links
        while more := {
            b for pair in links for a, b in (pair, pair[::-1])
            if a in found and b not in found | gone
        }:  # fmt: skip
            found |= more
        return found

    def _look_at_paths(self, life, told, gone):
        """A path is said to be broken where nobody is at its end, and nowhere else."""
        ends = self.stage.ends[life.host.number]
        of_gone = {here for number in gone for here, _ in self.stage.ends[number]}
        for (_, there), path in zip(ends, told["paths"], strict=True):
            if path["broken"] != (there in of_gone):
                is_broken = "is broken" if path["broken"] else "is not broken"
                end = "not there" if there in of_gone else "there"
                self._fail(life, f"{path['name']} {is_broken}, and its end is {end}")

    def _fail(self, life, text):
        self.world.fail(f"{life.name}: {text}")
