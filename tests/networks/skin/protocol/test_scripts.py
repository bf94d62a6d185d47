"""Transcripts: small networks stepped by hand, what happens written beneath each command.

A block is some commands, a line `----`, what they gave, and an empty line. What follows `#` is a
remark. INNERVATE_REWRITE=1 python -m pytest tests/networks/skin/protocol writes what
is given now: read it before you keep it. Commands, with nodes by name (`pc` is the PC):

    net rule=paper k=2 pc-1 1-2    a new network, its [protocol] keys and cables
    tick 1 2 3                     these nodes' periods are over, one after the other
    soon 1                         the send-soon timer of a node fires
    periods 5                      so many times all nodes tick and everything arrives
    settle 12                      the same, but only the state afterwards is told
    deliver 1->2, deliver all      the oldest frame on that cable arrives; everything arrives
    lose 1->2, detect 1->pc        that frame is lost; 1 finds its port to the PC broken
    cut 1-2, restore 1-2           a cable
    kill 1, revive 1, restart 1    a node; restart loses its memory and nothing else
    draw 1                         the next random choices of all cells (-1: random again)
    sample 1                       a cell reads its sensors
    show, wires, penalty 1         all nodes; what is under way; failure penalties of a cell
"""

from pathlib import Path

import pytest

from innervate import scenario
from innervate.networks.skin.protocol.constants import NONE
from innervate.networks.skin.sim.simulate import simulate
from tests.networks import transcripts
from tests.networks.skin.bench import REAL
from tests.networks.skin.net import Net
from tests.networks.skin.runs import loops_closed

FILES = sorted((Path(__file__).parent / "scripts").glob("*.txt"))
skin = REAL.skin
DROPS = {skin.DROP_NO_ROUTE: "no route", skin.DROP_LOOP: "a loop"}


class Player:
    """Plays commands on a network and says what changes."""

    def __init__(self):
        self.net = None
        self.seen = {}
        self.told = 0
        self.ring = []

    def play(self, line):
        """One command; what it gave, as lines."""
        verb, *words = line.split("#")[0].split()
        given = getattr(self, f"do_{verb}")(*words) or []
        return given + self.changes()

    def changes(self):
        """Reports and states since the last command."""
        net = self.net
        lines = [self.report(*row) for row in net.reports[self.told :] if self.is_cabled(*row)]
        self.told = len(net.reports)
        for frame in net.delivered:
            lines.append(f"the PC gets sample {frame.seq} of {self.name(frame.cell)}, "
                         f"{frame.hops} hops")  # fmt: skip
        net.delivered.clear()
        for node in range(net.graph.nodes):
            state = self.state(node)
            if self.seen.get(node) != state:
                lines.append(state)
            self.seen[node] = state
        ring = net.ring()
        if ring != self.ring:
            around = " -> ".join([*ring, ring[0]]) if ring else ""
            lines.append(f"CLOSED LOOP {around}" if ring else "no loop any more")
        self.ring = ring
        return lines

    def is_cabled(self, node, code, port, _):
        return code != skin.REPORT_BROKEN or self.net.graph.peer[4 * node + port] >= 0

    def name(self, node):
        return self.net.graph.label(node)

    def far(self, node, port):
        """The name of the node on a port."""
        end = self.net.graph.peer[4 * node + port] if port != NONE else -1
        return self.name(self.net.graph.node_of(end)) if end >= 0 else "nobody"

    def report(self, node, code, a, b):
        who = self.name(node)
        if code == skin.REPORT_BROKEN:
            return f"{who} finds its cable to {self.far(node, a)} {'broken' if b else 'whole'}"
        if code == skin.REPORT_DROP:
            return f"{who} drops a sample: {DROPS[a]}"
        if code == skin.REPORT_FORGET:
            return f"{who} forgets its feasible distance"
        why = " for balance" if code == skin.REPORT_BALANCE else ""
        return f"{who} goes from {self.far(node, a)} to {self.far(node, b)}{why}"

    def state(self, node):
        net = self.net
        if node == net.graph.sink:
            own = net.pc.own[0]
            number = f"sq {own.sq}" if own.sq_known else "listens"
            return f"pc: {number}, ports {' '.join(map(str, net.pc.size))}"
        if node in net.dead:
            return f"{self.name(node)}: dead"
        cell = net.cells[node]
        away = net.distance(node)
        fd = f"({cell.fd_sq}, {cell.fd_dist})" if cell.fd_known else "none"
        return (
            f"{self.name(node)}: D {'inf' if away == 255 else away}, "
            f"parent {net.parent(node) or 'none'}, sq {cell.sq_own}, fd {fd}, L {cell.own_load}"
        )

    def end(self, text):
        here, _, there = text.partition("->" if "->" in text else "-")
        return self.net.end(here, there)

    # Commands.

    def do_net(self, *words):
        keys = dict(word.split("=") for word in words if "=" in word)
        keys = {name: int(value) if value.isdigit() else value for name, value in keys.items()}
        links = [tuple(word.split("-")) for word in words if "=" not in word]
        if "balance_periods" in keys:
            keys["balancing"] = True
        self.net, self.seen, self.told, self.ring = Net(links, **keys), {}, 0, []
        self.changes()

    def do_tick(self, *names):
        for name in names:
            self.net.tick(name)

    def do_soon(self, name):
        self.net.soon(name)

    def do_periods(self, count):
        for _ in range(int(count)):
            self.net.period()

    def do_settle(self, count):
        self.do_periods(count)
        self.told = len(self.net.reports)
        self.seen.clear()

    def do_deliver(self, *ways):
        if ways == ("all",):
            self.net.deliver_all()
            return None
        return [f"nothing on {way}" for way in ways if not self.net.deliver(self.end(way))]

    def do_lose(self, way):
        return [] if self.net.lose(self.end(way)) else [f"nothing on {way}"]

    def do_cut(self, cable):
        self.net.cut(self.end(cable))

    def do_restore(self, cable):
        self.net.restore(self.end(cable))

    def do_detect(self, way):
        self.net.detect(self.end(way))

    def do_kill(self, name):
        self.net.kill(self.net.node(name))

    def do_revive(self, name):
        self.net.revive(self.net.node(name))

    def do_restart(self, name):
        self.net.start(self.net.node(name))

    def do_draw(self, value):
        for cell in self.net.cells:
            cell.choice = int(value)

    def do_sample(self, name):
        self.net.sample(self.net.node(name))

    def do_show(self):
        self.seen.clear()

    def do_penalty(self, name):
        node = self.net.node(name)
        cell = self.net.cells[node]
        ports = [port for port in range(4) if self.net.graph.peer[4 * node + port] >= 0]
        return [f"{name}: " + ", ".join(
            f"{cell.pf[port]}/840 to {self.far(node, port)}" for port in ports)]  # fmt: skip

    def do_wires(self):
        lines = []
        for end, frames in self.net.wires.items():
            way = f"{self.name(self.net.graph.node_of(end))}->"
            way += self.name(self.net.graph.node_of(self.net.graph.peer[end]))
            for frame in frames:
                told = ", you are my parent" if frame.parent else ""
                dist = "inf" if frame.dist == 255 else frame.dist
                lines.append(f"{way}: D {dist}, sq {frame.sq}, L {frame.load}, S {frame.size}{told}"
                             if frame.kind == skin.BEACON else f"{way}: a sample")  # fmt: skip
        return lines


def replay(text):
    """The transcript with what its commands give now."""
    player, lines, commands, expected = Player(), [], [], False
    for line in text.splitlines():
        if line == "----":
            given = []
            for command in commands:
                given += player.play(command)
            lines += ["----", *(given or ["nothing changes"])]
            commands, expected = [], True
        elif not line.strip():
            lines.append("")
            expected = False
        elif not expected:
            lines.append(line)
            if not line.startswith("#"):
                commands.append(line)
    assert not commands, f"no ---- beneath {commands}"
    return "\n".join(lines) + "\n"


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_transcript(path):
    transcripts.check(path, replay)


@pytest.mark.parametrize("rule", ["paper", "paper-lax", "feasible", "strict"])
@pytest.mark.parametrize("name", ["loop-five", "loop-three"])
def test_bundled_counterexamples_loop_under_the_papers_rules_only(name, rule):
    chosen = scenario.load(scenario.bundled()[name], [f"protocol.rule={rule}"])
    result = simulate(scenario.plan(chosen))
    assert (loops_closed(result) > 0) == rule.startswith("paper")


def test_there_are_transcripts():
    assert len(FILES) >= 8
