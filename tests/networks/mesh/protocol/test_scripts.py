"""Transcripts of a small mesh: what is on the air and what is reported, beneath each command.

As in test_scripts.py: some commands, a line `----`, what they gave, an empty line; what follows `#`
is a remark; INNERVATE_REWRITE=1 writes what is given now. Commands, nodes by number, 0 the gateway:

    net 0-1 1-2 robot=2 mode=1    links, robots (with a fence of 10 m x 10 m), parameters
    run 500                       so many ms; what is reported and delivered, at which ms
    hear 500                      the same, and what is on the air
    send 2 0 hello                a message; `sample 2 500 -50` where a robot is, cm
    kill 1, revive 1, cut 0 1, join 0 1
    tables                        everybody's next hops and (alternates)
"""

from pathlib import Path

import pytest

from innervate.networks.mesh.protocol import constants as const
from tests.networks import transcripts
from tests.networks.mesh.net import Net

FILES = sorted((Path(__file__).parent / "scripts").glob("*.txt"))
FENCE = dict(points=4, px=[0, 1000, 1000, 0] + [0] * 44, py=[0, 0, 1000, 1000] + [0] * 44,
             after=[1, 2, 3, 0] + [0] * 44)  # fmt: skip
NAMES = ["REQUEST", "RESPONSE", "TABLE", "TABLE_ACK", "DATA", "E2E_ACK"]
NAMES += ["ALARM", "POSITION", "GRAPH", "ACK"]
KINDS = {getattr(const, name): name.lower().replace("_", " ") for name in NAMES}
ALARM_KINDS = ["predict", "cross", "lost", "clear"]
REPORTS = {
    const.REPORT_HOP: "message {a} has left",
    const.REPORT_ARRIVED: "message {a} has arrived",
    const.REPORT_EXPIRED: "message {a} is given up",
    const.REPORT_DROPPED: "a packet of {a} is dropped",
    const.REPORT_SUSPECT: "suspects {a}",
    const.REPORT_ROUND: "begins a round",
    const.REPORT_GRAPH: "knows {a} links",
    const.REPORT_TABLE: "has its table",
    const.REPORT_TABLES: "has handed out all tables; {b} nodes are without",
    const.REPORT_GATEWAY: "follows {a}",
}


class Player:
    """Plays commands on a net and says what happens."""

    def play(self, line):
        verb, *rest = line.split("#")[0].split()
        return getattr(self, f"do_{verb}")(*rest) or []

    def do_net(self, *rest):
        links = [tuple(map(int, word.split("-"))) for word in rest if "-" in word]
        keys = dict(word.split("=") for word in rest if "=" in word)
        robot = keys.pop("robot", None)
        settings = {key: int(value) for key, value in keys.items()}
        if robot is not None:
            settings = {**settings, **FENCE, "robots": (int(robot),)}
        self.net = Net(1 + max(map(max, links)), links, thorough=True, **settings)

    def do_run(self, ms, aloud=False):
        net = self.net
        net.sent, net.delivered = net.sent if aloud else [], []
        start, net.reports = net.now, [row for row in net.reports if aloud]
        net.run(start + 1000 * int(ms))
        told = [(at, self.frame(i, frame)) for at, i, frame in net.sent if aloud]
        told += [(at, self.delivery(i, frame)) for at, i, frame in net.delivered]
        told += [(at, f"{i} " + REPORTS[code].format(a=a, b=b))
                 for at, i, code, a, b in net.reports if code in REPORTS]  # fmt: skip
        net.sent, net.reports = [], []
        told.sort(key=lambda row: row[0])
        return [f"{(at - start) / 1000:7.1f}  {text}" for at, text in told]

    def do_hear(self, ms):
        return self.do_run(ms, aloud=True)

    def frame(self, i, frame):
        to = "all" if frame.link_dst == const.ALL else frame.link_dst
        path = "" if frame.kind == const.ACK else ", path " + " ".join(
            map(str, frame.path[: frame.path_len]))  # fmt: skip
        return f"{i} -> {to}: {KINDS[frame.kind]} of {frame.origin}{path}"

    def delivery(self, i, frame):
        if frame.kind == const.ALARM:
            return f"{i} GETS {ALARM_KINDS[frame.body[3]]} of robot {frame.body[0]}"
        return f"{i} GETS '{bytes(frame.body[: frame.length]).decode()}' of {frame.origin}"

    def do_send(self, i, dest, text):
        self.net.sent, self.net.reports = [], []
        self.net.send(int(i), int(dest), text.encode())

    def do_sample(self, i, x, y):
        self.net.sent, self.net.reports = [], []
        self.net.sample(int(i), int(x), int(y))

    def do_kill(self, i):
        self.net.kill(int(i))

    def do_revive(self, i):
        self.net.revive(int(i))

    def do_cut(self, a, b):
        self.net.cut(int(a), int(b))

    def do_join(self, a, b):
        self.net.join(int(a), int(b))

    def do_tables(self):
        lines = []
        for i, node in enumerate(self.net.nodes):
            row = []
            for dest in range(len(self.net.nodes)):
                at = node.bank * 32 + dest
                if node.next[at] != const.ALL:
                    other = "" if node.alt[at] == const.ALL else f" ({node.alt[at]})"
                    row.append(f"to {dest} by {node.next[at]}{other}")
            lines.append(f"{i}: " + ", ".join(row))
        return lines


def played(text):
    """The transcript of this file's commands."""
    player = Player()
    blocks = []
    for block in text.strip().split("\n\n"):
        commands = block.split("\n----")[0].split("\n")
        given = []
        for line in commands:
            if line.split("#")[0].strip():
                given += player.play(line)
        blocks.append("\n".join([*commands, "----", *given]))
    return "\n\n".join(blocks) + "\n"


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_script(path):
    transcripts.check(path, played)


def test_there_are_scripts():
    assert len(FILES) >= 4
