"""The toolkit's lab, with what is done to its cables and nodes while they are compared."""

from innervate.live import netns
from innervate.live.netns import UDP_PORT

_ETHERNET_BYTES = 14


class Lab(netns.Lab):
    """Namespaces whose cables are cut in silence, and whose bytes are counted."""

    def peers(self, node: int) -> list[str]:
        """UDP addresses at the far ends of a node's cables."""
        return [
            f"{self.address(k, a if b == node else b)}:{UDP_PORT}"
            for k, (a, b) in enumerate(self.links)
            if node in (a, b)
        ]

    def interfaces(self, node: int) -> list[str]:
        """A node's ends of cables."""
        return [f"c{k}" for k, ends in enumerate(self.links) if node in ends]

    def cut(self, link: int) -> None:
        """Drop whatever arrives over a cable, both ways; its carrier stays up, nobody is told."""
        self._set("add", link)

    def restore(self, link: int) -> None:
        """Let frames over a link again, as before `cut`."""
        self._set("delete", link)

    def isolate(self, node: int) -> None:
        """Drop whatever arrives at a node, on all its cables in the same moment."""
        self._change("add", node, self.interfaces(node))

    def rejoin(self, node: int) -> None:
        """Let a node's frames out again, as before `isolate`."""
        self._change("delete", node, self.interfaces(node))

    def _set(self, what: str, link: int) -> None:
        for node in self.links[link]:
            self._change(what, node, [f"c{link}"])

    def _change(self, what: str, node: int, names: list[str]) -> None:
        element = ["element", "inet", "innervate", "cut", "{", ", ".join(names), "}"]
        self.run(node, ["nft", what, *element])

    def ip_bytes(self, link: int) -> int:
        """IP bytes sent on a cable so far, both ways, headers of IP included."""
        total = 0
        for node in self.links[link]:
            folder = f"/sys/class/net/c{link}/statistics"
            text = self.run(node, ["cat", f"{folder}/tx_bytes", f"{folder}/tx_packets"])
            count, packets = map(int, text.split())
            total += count - _ETHERNET_BYTES * packets
        return total
