"""live_up(scenario) -> a scenario's nodes as processes, held by a program or a notebook."""

import asyncio
import atexit
import os
import threading
from collections.abc import Coroutine
from html import escape
from pathlib import Path
from typing import Any, Literal, Self, TypeVar

from innervate import scenario as scenarios
from innervate.live import play, run_up, status
from innervate.live.errors import LiveError
from innervate.live.receipts import ALL, FINAL, check_bytes
from innervate.network import networks
from innervate.scenario.given import Changes, Given, load

Answer = TypeVar("Answer")
HOW = ("reliable", "priority", "in_order")


class Nodes:
    """Running nodes, each a process of its own; a context manager that ends them.

    The scenario's events happen at their times, from the moment at which all nodes are up. Where
    nobody ends them, they end with the program.

    Attributes:
        names: every node's name, by number.
        cables: pairs of names.
        folder: of node files, logs and sockets; `innervate live status` finds the nodes there.
        played: what has happened so far, a line each.
    """

    def __init__(self, plan: Any, way: run_up.Way, text: str) -> None:
        self._way, self._network = way, run_up.prepared(plan, way)
        self.folder = self._network.folder
        self.names = list(self._network.names)
        self.cables = [(self.names[a], self.names[b]) for a, b in self._network.links]
        self.played: list[str] = []
        self._loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=self._loop.run_forever, daemon=True)
        self._thread.start()
        atexit.register(self.down)
        try:
            self._do(run_up.up(self._network, text))
        except BaseException:
            self.down()
            raise
        player = play.Player(self._network, play.events(self._network.deployment), self._tell)
        self._playing = asyncio.run_coroutine_threadsafe(player.play(), self._loop)

    def __repr__(self) -> str:
        state = f"{len(self._alive())} running" if self._thread.is_alive() else "ended"
        return f"Nodes({len(self.names)} of {self._network.plan.kind!r}, {state})"

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.down()

    def status(self) -> dict[str, dict[str, Any]]:
        """What each node that runs says of itself, by name: what `live status --json` prints."""
        return {name: self.ask(name, do="status") for name in self._alive()}

    def ask(self, name: str, **request: Any) -> dict[str, Any]:
        """A node's first answer to a request, as its status socket takes them.

        Raises:
            LiveError: there is no such node, it does not run, or it refuses.
        """
        return status.ask_one(self._network.socket(self._known(name)), request)

    def send(self, name: str, to: int, payload: bytes, **how: bool) -> str:
        """Have a node send a message; what became of it: "delivered", "expired", ...

        Args:
            name: the node that sends.
            to: number of the recipient; 255 all, 254 the monitor.
            payload: the message.
            how: reliable, priority, ... as `innervate live send` has them; reliable if left out.

        Raises:
            LiveError: there is no such node, or it takes no messages.
            TypeError: the payload is no bytes, or no message is sent so.
        """
        check_bytes(payload)
        if unknown := how.keys() - HOW:
            said = ", ".join(sorted(unknown))
            raise TypeError(f"send takes no {said}; it takes {', '.join(HOW)}")
        how = {"reliable": True, **how}
        request = {"do": "send", "to": to, "payload": payload.hex(), **how}
        request["wait"] = how["reliable"] and to != ALL
        state = "refused"
        for answer in status.ask(self._network.socket(self._known(name)), request):
            state = str(answer["state"])
            if state in FINAL or not request["wait"]:
                break
        return state

    def cut(self, a: str, b: str) -> None:
        """Cut the cable between two nodes, in silence.

        Raises:
            LiveError: no cable joins them.
        """
        self._do(self._network.change(self._cable(a, b), "cut"))

    def restore(self, a: str, b: str) -> None:
        """Put the cable between two nodes back.

        Raises:
            LiveError: no cable joins them.
        """
        self._do(self._network.change(self._cable(a, b), "restore"))

    def kill(self, name: str) -> None:
        """Kill a node's process, without its noticing."""
        self._do(self._network.end_node(self._known(name), gently=False))

    def start(self, name: str) -> None:
        """Start a node again that was killed.

        Raises:
            LiveError: it does not come up.
        """
        self._do(self._network.begin_node(self._known(name)))

    def down(self) -> None:
        """End all of them; a folder that was made for them is removed."""
        if not self._thread.is_alive():
            return
        atexit.unregister(self.down)
        self._do(self._end())
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join()
        self._loop.close()

    async def _end(self) -> None:
        others = asyncio.all_tasks() - {asyncio.current_task()}
        for task in others:
            task.cancel()
        await asyncio.gather(*others, return_exceptions=True)
        await run_up.down(self._network, self._way)

    def _repr_html_(self) -> str:
        """In a notebook: what each node says of itself."""
        words = networks()[self._network.plan.kind].live_words
        rows = "".join(
            f"<tr><th>{escape(name)}</th><td>{escape(told['role'])}</td>"
            f"<td>{'<br>'.join(escape(line.strip()) for line in words.lines(told))}</td></tr>"
            for name, told in self.status().items()
        )
        return f"<p>{escape(repr(self))}</p><table>{rows}</table>"

    def _do(self, what: Coroutine[Any, Any, Answer]) -> Answer:
        if not self._thread.is_alive():
            what.close()
            raise LiveError("these nodes have been ended; bring the scenario up again")
        return asyncio.run_coroutine_threadsafe(what, self._loop).result()

    def _tell(self, event: play.Event) -> None:
        self.played.append(f"{event.at_s:g} s: {event.text}")

    def _alive(self) -> list[str]:
        return [name for name in self.names if status.answers(self._network.socket(name))]

    def _known(self, name: str) -> str:
        if name not in self.names:
            raise LiveError(f"no node is called {name!r}; they are {', '.join(self.names[:20])}")
        return name

    def _cable(self, a: str, b: str) -> int:
        for number, ends in enumerate(self.cables):
            if set(ends) == {self._known(a), self._known(b)}:
                return number
        raise LiveError(f"no cable joins {a} and {b}")


def live_up(
    scenario: Given,
    *,
    seed: int | None = None,
    overrides: Changes = (),
    folder: str | os.PathLike[str] | None = None,
    cables: Literal["udp", "pty", "netns"] = "udp",
    keys: Literal["", "key", "identities"] = "",
) -> Nodes:
    """Bring a scenario up as running nodes, each a process, as `innervate live up` does.

    Args:
        scenario: as for run().
        seed: in place of the scenario's.
        overrides: "a.b=c" texts, or a mapping from dotted keys to values.
        folder: for node files, logs and sockets; a temporary one if None.
        cables: "udp" on loopback, "pty" for serial lines, "netns" for network namespaces (root).
        keys: "key" seals frames with one key of all nodes, "identities" with one for each; "" does
            not seal them.

    Raises:
        ScenarioError: the scenario is not valid.
        LiveError: it cannot be run live, or a node does not come up.
    """
    loaded = load(scenario, seed=seed, overrides=overrides)
    way = run_up.Way(None if folder is None else Path(folder), cables, keys)
    return Nodes(scenarios.plan(loaded), way, scenarios.dump(loaded))
