"""What is compared: each side runs its nodes in a lab and says where packets go."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

from benchmarks.live.lab import Lab
from benchmarks.live.shapes import Shape
from innervate.live.netns import UDP_PORT

ENDS = str(Path(__file__).with_name("ends.py"))


class Side:
    """Nodes as processes; the two ends besides, or as nodes of their own."""

    def __init__(self, shape: Shape, lab: Lab, folder: Path, urgency: list[str]):
        self.shape, self.lab, self.folder, self.urgency = shape, lab, folder, urgency
        self.nodes: dict[int, subprocess.Popen] = {}
        self.ends: dict[int, subprocess.Popen] = {}

    def spawn(self, node, command, **options):
        log = (self.folder / f"{node}.log").open("a")
        return subprocess.Popen(
            [*self.urgency, *self.lab.inside(node, command)], stderr=log, **options
        )

    def spawn_end(self, node, *words):
        return self.spawn(
            node, [sys.executable, ENDS, *words],
            stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
        )  # fmt: skip

    def tell(self, node, command):
        self.ends[node].stdin.write(command + "\n")
        self.ends[node].stdin.flush()

    def hear(self, node):
        return json.loads(self.ends[node].stdout.readline())

    def ask(self, node, command):
        self.tell(node, command)
        return self.hear(node)

    def daemons(self):
        """Processes whose CPU time and memory count: of nodes in the middle."""
        ends = (self.shape.source, self.shape.sink)
        return [process.pid for node, process in self.nodes.items() if node not in ends]

    def kill(self, node):
        """A node dies without a word: nothing arrives there any more, nothing leaves."""
        self.lab.isolate(node)
        self.nodes[node].send_signal(signal.SIGKILL)
        self.nodes[node].wait()

    def revive(self, node):
        self.lab.rejoin(node)
        self.nodes[node] = self.start_node(node)

    def stop(self):
        for process in (*self.ends.values(), *self.nodes.values()):
            if process.poll() is None:
                process.terminate()
        for process in (*self.ends.values(), *self.nodes.values()):
            process.wait()


class Innervate(Side):
    name = "innervate"
    settle_s = 5.0  # two discovery rounds

    def __init__(self, *args, settings=None):
        super().__init__(*args)
        self.settings = settings or {}

    def start(self):
        for node in range(self.shape.count):
            self._write(node)
            if node in (self.shape.source, self.shape.sink):
                self.ends[node] = self.spawn_end(node, "mesh", str(self._file(node)))
            else:
                self.nodes[node] = self.start_node(node)

    def start_node(self, node):
        script = Path(sys.executable).with_name("innervate")
        return self.spawn(node, [str(script), "live", "node", str(self._file(node))])

    def _file(self, node):
        return self.folder / f"n{node}.toml"

    def _write(self, node):
        middle = self.shape.count // 2 if self.shape.name.startswith("hex") else 1
        role = "gateway" if node == middle else "node"
        lines = [
            'kind = "mesh"', f"number = {node}", f"nodes = {self.shape.count}", f'role = "{role}"',
            f'socket = "{self.folder / f"n{node}.sock"}"',
            "[protocol]", *(f"{key} = {value}" for key, value in self.settings.items()),
            "[[link]]", 'kind = "udp"', f'bind = "0.0.0.0:{UDP_PORT}"',
            f"peers = {json.dumps(self.lab.peers(node))}",
        ]  # fmt: skip
        self._file(node).write_text("\n".join(lines) + "\n")

    def target(self):
        return str(self.shape.sink)

    def path(self):
        """The nodes that packets pass now, as the newest one says."""
        self.ask(self.shape.source, f"go 5 {self.target()}")
        told = self.ask(self.shape.sink, "status")
        return told["arrived_by"].get(str(self.shape.source), [])


class Babeld(Side):
    name = "babeld"
    settle_s = 3.0

    def start(self):
        for node in range(self.shape.count):
            self.nodes[node] = self.start_node(node)
        for node in (self.shape.source, self.shape.sink):
            self.ends[node] = self.spawn_end(node, "udp", self.lab.loopback(node))

    def start_node(self, node):
        own = f"{self.lab.loopback(node)}/32"
        command = [
            "babeld", "-h", "0.02", "-H", "0.02",
            "-S", str(self.folder / f"{node}.state"), "-I", str(self.folder / f"{node}.pid"),
            "-C", f"redistribute local ip {own} allow", "-C", "redistribute local deny",
            *self.lab.interfaces(node),
        ]  # fmt: skip
        Path(self.folder / f"{node}.pid").unlink(missing_ok=True)
        return self.spawn(node, command)

    def target(self):
        return self.lab.loopback(self.shape.sink)

    def path(self):
        target, at, found = self.target(), self.shape.source, [self.shape.source]
        while at != self.shape.sink and len(found) < self.shape.count:
            words = self.lab.run(at, ["ip", "route", "get", target]).split()
            a, b = self.shape.links[int(words[words.index("dev") + 1][1:])]
            at = b if at == a else a
            found.append(at)
        return found


def cpu_s(pid):
    """Seconds of CPU that a process has used."""
    fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def memory_mib(pid):
    for line in Path(f"/proc/{pid}/status").read_text().splitlines():
        if line.startswith("VmRSS"):
            return int(line.split()[1]) / 1024
    return 0.0


def now_ns():
    return time.monotonic_ns()
