"""A page as the server sees it: connects to the socket, keeps what it is told, gives commands."""

import asyncio
import json
from urllib.parse import parse_qs, urlsplit

import websockets

WAIT_S = 20.0


def socket_of(address, token=None):
    """The socket's address of a page's address."""
    parts = urlsplit(address)
    token = parse_qs(parts.query)["token"][0] if token is None else token
    return f"ws://{parts.netloc}/socket?token={token}"


class Page:
    """What a page knows: scene, state, lines of the log, points, answers."""

    def __init__(self, address, **how):
        self.address = address
        self.how = how
        self.scenes, self.state, self.lines, self.answers = [], {}, [], []
        self.series, self.timeline, self.states, self.backs = {}, [], 0, []

    async def __aenter__(self):
        self.socket = await websockets.connect(socket_of(self.address), max_size=None, **self.how)
        return self

    async def __aexit__(self, *_):
        await self.socket.close()

    @property
    def scene(self):
        return self.scenes[-1]

    async def take(self, limit_s=WAIT_S):
        """Take in one message."""
        message = json.loads(await asyncio.wait_for(self.socket.recv(), limit_s))
        kind = message.pop("type")
        if kind == "scene":
            self.scenes.append(message)
            self.state, self.series, self.timeline, self.lines = {}, {}, [], []
        elif kind == "state":
            self.states += 1
            if "back_s" in message:
                self.go_back(message.pop("back_s"))
            for name, points in message.pop("series", {}).items():
                self.series.setdefault(name, []).extend(map(tuple, points))
            self.timeline += message.pop("timeline", [])
            self.state |= message
        elif kind == "log":
            self.lines.append(message)
        else:
            self.answers.append({"type": kind, **message})
        return kind

    def go_back(self, back_s):
        self.backs.append(back_s)
        for name, points in self.series.items():
            self.series[name] = [point for point in points if point[0] <= back_s]
        self.timeline = [box for box in self.timeline if box["to_s"] <= back_s]
        self.lines = [line for line in self.lines if line["t_s"] < back_s]

    async def until(self, what, limit_s=WAIT_S):
        """Take messages until `what()` is true."""
        async with asyncio.timeout(limit_s):
            while not what():
                await self.take()

    async def closed(self, limit_s=WAIT_S):
        """Take messages until the server hangs up; its code."""
        async with asyncio.timeout(limit_s):
            while True:
                try:
                    await self.take()
                except websockets.ConnectionClosed:
                    return self.socket.close_code

    async def give(self, do, **fields):
        await self.socket.send(json.dumps({"do": do, **fields}))

    async def ask(self, do, **fields):
        """Give a command and wait for its answer."""
        before = len(self.answers)
        await self.give(do, **fields)
        await self.until(lambda: len(self.answers) > before)
        return self.answers[-1]

    def text(self):
        return "\n".join(line["text"] for line in self.lines)
