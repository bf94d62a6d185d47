"""Network namespaces: every node has its own, every link is a cable of two virtual interfaces.

Needs root, iproute2 and, to cut cables, nftables. Namespaces are named PREFIX-NUMBER.
"""

import shutil
import subprocess
from ipaddress import IPv4Address

from innervate.live.errors import LiveError

UDP_PORT = 4700
_CABLES = int(IPv4Address("10.77.0.0"))
_LOOPS = int(IPv4Address("10.78.0.0"))
RULES = """table inet innervate {
  set cut { type ifname; }
  chain arrivals { type filter hook prerouting priority raw; policy accept; iifname @cut drop; }
}
"""


class Lab:
    """Namespaces for nodes 0 .. count - 1, joined by cables.

    Args:
        prefix: in front of the namespaces' names, at most 8 letters; two labs need two.
        count: nodes.
        links: pairs of nodes, in order of the cables' numbers.

    Raises:
        LiveError: a tool is missing, or this is not root.
    """

    def __init__(self, prefix: str, count: int, links: list[tuple[int, int]]) -> None:
        self.prefix = prefix
        self.count = count
        self.links = links
        for tool, package in (("ip", "iproute2"), ("nft", "nftables")):
            if shutil.which(tool) is None:
                raise LiveError(f"network namespaces need {tool}; install {package}")

    def name(self, node: int) -> str:
        """What a node's network namespace is called."""
        return f"{self.prefix}-{node}"

    def address(self, link: int, node: int) -> str:
        """A node's address on a cable."""
        return str(IPv4Address(_CABLES + 4 * link + 1 + (self.links[link][1] == node)))

    def loopback(self, node: int) -> str:
        """A node's own address, for routing daemons."""
        return str(IPv4Address(_LOOPS + 1 + node))

    def up(self) -> None:
        """Make the namespaces; what an earlier run left under this prefix is removed."""
        self.down()
        for node in range(self.count):
            _ip("netns", "add", self.name(node))
        for k in range(len(self.links)):
            self.plug(k)
        for node in range(self.count):
            lines = ["link set lo up", f"addr add {self.loopback(node)}/32 dev lo"]
            _ip("-n", self.name(node), "-batch", "-", text="\n".join(lines) + "\n")
            self.run(node, ["nft", "-f", "-"], RULES)
            knobs = ["net.ipv4.ip_forward=1", "net.ipv4.conf.all.rp_filter=0"]
            self.run(node, ["sysctl", "-qw", *knobs])

    def plug(self, link: int) -> None:
        """Make a cable: two interfaces with their addresses."""
        here, there = (self.name(node) for node in self.links[link])
        _ip("link", "add", f"c{link}", "netns", here, "type", "veth",
            "peer", "name", f"c{link}", "netns", there)  # fmt: skip
        for node in self.links[link]:
            lines = [f"addr add {self.address(link, node)}/30 dev c{link}", f"link set c{link} up"]
            _ip("-n", self.name(node), "-batch", "-", text="\n".join(lines) + "\n")

    def down(self) -> None:
        """Remove the namespaces; processes in them lose their interfaces."""
        listed = subprocess.run(
            ["ip", "netns", "list"], capture_output=True, text=True, check=False
        ).stdout
        for line in listed.splitlines():
            name = line.split()[0]
            if name.rpartition("-")[0] == self.prefix:
                _ip("netns", "del", name)

    def inside(self, node: int, command: list[str]) -> list[str]:
        """The command line that runs a command in a node's namespace."""
        return ["ip", "netns", "exec", self.name(node), *command]

    def run(self, node: int, command: list[str], text: str = "") -> str:
        """The output of a command, run in a namespace; LiveError if it failed."""
        return _run(self.inside(node, command), text)


def _ip(*words: str, text: str = "") -> str:
    return _run(["ip", *words], text)


def _run(command: list[str], text: str = "") -> str:
    done = subprocess.run(command, input=text, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        why = done.stderr.strip().splitlines() or ["failed"]
        raise LiveError(f"{' '.join(command[:6])}: {why[-1]}; namespaces need root")
    return done.stdout
