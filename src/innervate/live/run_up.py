"""`innervate live up`: a scenario's network, and what happens to it, until somebody ends it."""

import asyncio
import json
import os
import secrets
import shutil
import signal
import sys
import tempfile
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

from innervate.live import play, private, status
from innervate.live.errors import LiveError
from innervate.live.up import Processes

SCENARIO = "scenario.toml"
OURS = "# As `innervate live up` brought it up; the next one in this folder replaces it."
LOOKED_S = 0.5  # so often it is looked whether a node ended
SIGNAL_S = 0.2  # a node that a signal ended is seen before that signal is
MANY = 50  # nodes
NODE_MB, KEYED_MB = 27, 34  # that a node's process holds, in the clear and with keys
MARK = "made-by-live-up"  # among keys that may be replaced
CABLES = ("udp", "pty", "netns")
SEALS = ("", "key", "identities")


class Way(NamedTuple):
    """How nodes are brought up.

    Attributes:
        folder: for node files, logs and sockets; a temporary one if None.
        cables: "udp", "pty" or "netns".
        sealed: with a "key" of all nodes, with "identities", or in the clear ("").
        images: by name, what runs a node's protocol on an emulated board.
        engine: what runs it here: "python", "c" or "auto"; "" = as node files have it.
    """

    folder: Path | None
    cables: str
    sealed: str
    images: Mapping[str, Path] = {}
    engine: str = ""


async def run(plan: Any, way: Way, scenario: str, for_s: float, as_json: bool) -> int:
    """Bring a scenario up and keep it until Ctrl-C, SIGTERM or the time is over; 0.

    Raises:
        KeyboardInterrupt: Ctrl-C or SIGTERM came before all were up; they are ended.
    """
    network = prepared(plan, way)
    ending = asyncio.Event()
    loop = asyncio.get_running_loop()
    for number in (signal.SIGTERM, signal.SIGINT):
        loop.add_signal_handler(number, ending.set)
    began = time.monotonic()
    try:
        player = _player(network, as_json)
        _foretell(network)
        if not await _came_up(asyncio.create_task(up(network, scenario)), ending):
            raise KeyboardInterrupt
        with status.findable(network.folder):
            _announce(network, time.monotonic() - began, as_json)
            telling = asyncio.create_task(_tell_failed(network, as_json))
            try:
                await _until(ending, asyncio.create_task(player.play()), for_s)
            finally:
                telling.cancel()
        return 1 if network.failed() else 0
    finally:
        await down(network, way)


async def _tell_failed(network: Processes, as_json: bool) -> None:
    """Say of each node that ends by itself why it did, for ever."""
    told = set[str]()
    while True:
        for name, why in network.failed().items():
            if name not in told:
                told.add(name)
                said = {"ended": name, "why": why}
                print(json.dumps(said) if as_json else f"{name} ended: {why}", flush=True)
        await asyncio.sleep(LOOKED_S)


async def _came_up(starting: asyncio.Task[None], ending: asyncio.Event) -> bool:
    """True once all are up, False if somebody ends it before: Ctrl-C ends the first nodes, too."""
    ended = asyncio.ensure_future(ending.wait())
    await asyncio.wait({starting, ended}, return_when=asyncio.FIRST_COMPLETED)
    if starting.done() and starting.exception() is not None:
        await asyncio.wait({ended}, timeout=SIGNAL_S)
    ended.cancel()
    if not ending.is_set():
        starting.result()
        return True
    starting.cancel()
    await asyncio.gather(starting, return_exceptions=True)
    return False


def prepared(plan: Any, way: Way) -> Processes:
    """The processes to be of a plan, in their folder, with the keys that are wanted.

    Raises:
        LiveError: that is no way to bring nodes up, or the folder cannot be had.
    """
    for what, given, known in (("cables", way.cables, CABLES), ("keys", way.sealed, SEALS)):
        if given not in known:
            raise LiveError(f"{what} must be one of {', '.join(map(repr, known))}, not {given!r}")
    folder = Path(tempfile.mkdtemp(prefix="innervate-")) if way.folder is None else way.folder
    common = {"use": 1, "secret.1": secrets.token_hex(32)}
    keys = {"": None, "key": common, "identities": {}}[way.sealed]
    try:
        network = Processes(plan, folder.absolute(), way.cables, keys, way.images)
    except LiveError:
        if way.folder is None:
            folder.rmdir()
        raise
    network.engine = way.engine
    network.take_folder()
    _check_scenario(network.folder / SCENARIO)
    if way.sealed == "identities":
        network.keys = _identities(network)
    return network


async def up(network: Processes, scenario: str) -> None:
    """Bring them up; the scenario's text lies beside for whoever draws a map of the nodes.

    Raises:
        LiveError: a node does not come up.
    """
    await network.up()
    (network.folder / SCENARIO).write_text(f"{OURS}\n{scenario}", encoding="utf-8")


async def down(network: Processes, way: Way) -> None:
    """End them, and remove a folder that was made for them."""
    await network.down()
    if way.folder is None and os.path.isdir(network.folder):
        shutil.rmtree(network.folder, ignore_errors=True)


def _check_scenario(path: Path) -> None:
    """Refuse a scenario in the folder that no `live up` wrote: it may not be replaced."""
    try:
        is_ours = path.read_text(encoding="utf-8").startswith(OURS)
    except FileNotFoundError:
        return
    except (OSError, ValueError):
        is_ours = False
    if not is_ours:
        raise LiveError(f"{path} is none that live up wrote; name another --folder")


def _identities(network: Processes) -> dict[str, Any]:
    """Have every node enrolled; the [keys] table. Keys that no `live up` made are refused."""
    from innervate.live.enrolment import Authority

    folder = network.folder / "keys"
    if folder.exists():
        if not (folder / MARK).is_file():
            raise LiveError(f"{folder} holds keys that live up did not make; name another --folder")
        shutil.rmtree(folder)  # of a run before
    folder.mkdir(mode=private.FOLDER)
    (folder / MARK).touch()
    authority = Authority(folder)
    for number in range(len(network.names)):
        authority.enrol(number)
    return {"identity": "keys/n{number}.identity"}


async def _until(ending: asyncio.Event, playing: asyncio.Task[None], limit_s: float) -> None:
    """Until a signal says stop, or the time (0 = none) is over, or a played event went wrong."""
    began = time.monotonic()
    ended = asyncio.ensure_future(ending.wait())
    both = {ended, playing}
    try:
        await asyncio.wait(both, timeout=limit_s or None, return_when=asyncio.FIRST_COMPLETED)
        if playing.done():
            playing.result()
            left_s = max(0.0, limit_s - (time.monotonic() - began)) if limit_s else None
            await asyncio.wait([ended], timeout=left_s)
    finally:
        ended.cancel()
        playing.cancel()
        await asyncio.gather(*both, return_exceptions=True)


def _player(network: Processes, as_json: bool) -> play.Player:
    """What plays the scenario; what cannot be played is said."""
    events = play.events(network.deployment)
    for event in events:
        if not play.is_played(event):
            print(f"not played: {event.what} at {event.at_s:g} s", file=sys.stderr)

    def tell(event: play.Event) -> None:
        told = {"at_s": event.at_s, "event": event.text}
        print(json.dumps(told) if as_json else f"{event.at_s:g} s: {event.text}", flush=True)

    return play.Player(network, events, tell)


def _foretell(network: Processes) -> None:
    """Say what many processes will take, before the first is started."""
    count = len(network.names) - len(network.absent)
    if count <= MANY:
        return
    need_gb = count * (KEYED_MB if network.keys else NODE_MB) / 1000
    print(
        f"starting {count} processes, one a node, which hold about {need_gb:.1f} GB; Ctrl-C ends "
        "them. A smaller one to try: innervate live up line",
        file=sys.stderr,
        flush=True,
    )


def _announce(network: Processes, took_s: float, as_json: bool) -> None:
    if as_json:
        nodes = {
            name: {"pid": network.processes[name].pid, "socket": str(network.socket(name))}
            for name in network.names
            if name in network.processes
        }
        told = {"folder": str(network.folder), "up_s": round(took_s, 3), "nodes": nodes}
        print(json.dumps(told), flush=True)
        return
    count = len(network.names) - len(network.absent)
    what = f"{len(network.links)} cables" if network.links else "their channel"
    print(f"{count} nodes and {what} are up after {took_s:.1f} s; Ctrl-C ends them.")
    print("Look: innervate live status, or innervate watch live, in another terminal.")
    print(f"They are in INNERVATE_RUN={network.folder}", flush=True)
