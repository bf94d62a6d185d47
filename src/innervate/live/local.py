"""In-process links: nodes of one program, joined without sockets."""

import asyncio

from innervate.live.links import Link, Path, Receiver


class LocalLink(Link):
    """One end of a cable inside a program, with the port number of its path; `pair` makes both."""

    def __init__(self, name: str, port: int = 0) -> None:
        self.path = LocalPath(name, port)
        self.paths = [self.path]

    async def open(self, receive: Receiver) -> None:
        """Hand what comes in to `receive` from now on."""
        self.path.receive = receive

    def close(self) -> None:
        """Unplugged: what is on its way is lost."""
        self.path.receive = None


class LocalPath(Path):
    """The path of an in-process link."""

    def __init__(self, name: str, port: int) -> None:
        super().__init__(f"local {name}", port)
        self.other: LocalPath | None = None
        self.receive: Receiver | None = None

    def send(self, data: bytes) -> None:
        """The other end has it in the loop's next turn."""
        if self.other is None or not self.carries:
            self.counters["unsent: unplugged"] += 1
            return
        self.sent(data)
        asyncio.get_running_loop().call_soon(self.other.take, data)

    def take(self, data: bytes) -> None:
        """Bytes come in from the other end; lost while the cable is cut."""
        if self.receive is not None and self.carries:
            self.receive(self, data)


def pair(name: str, ports: tuple[int, int] = (0, 0)) -> tuple[LocalLink, LocalLink]:
    """Both ends of a cable, with their port numbers."""
    a, b = LocalLink(name, ports[0]), LocalLink(name, ports[1])
    a.path.other, b.path.other = b.path, a.path
    a.path.ends, b.path.ends = (f"{name} a", f"{name} b"), (f"{name} b", f"{name} a")
    return a, b
