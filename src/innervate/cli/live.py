"""`innervate live`: nodes between real processes."""

from __future__ import annotations

import asyncio
import json
import sys
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from innervate.cli import errors, live_status
from innervate.live import status
from innervate.live.errors import LiveError
from innervate.live.receipts import ALL, FINAL
from innervate.network import known

if TYPE_CHECKING:
    from innervate.cli.options import UpOptions


def up(file: str, options: UpOptions) -> int:
    """Bring a scenario up as processes."""
    from innervate import scenario as scenarios
    from innervate.live import run_up as room

    loaded = scenarios.load(file, options.set_ or [])
    plan, text = scenarios.plan(loaded), scenarios.dump(loaded)
    if not options.firmware:
        if options.in_python:
            raise errors.UserError("--in-python says who stays in Python beside --firmware")
        way = room.Way(options.folder, options.cables, options.keys, engine=options.engine or "")
        return asyncio.run(room.run(plan, way, text, options.for_s, options.json))
    from innervate.firmware import patch

    if options.engine is not None:
        raise errors.UserError("--engine and --firmware exclude each other; name one")
    with tempfile.TemporaryDirectory(prefix="innervate-firmware-") as folder:
        images = patch.images(plan, Path(folder), options.in_python or [])
        way = room.Way(options.folder, options.cables, options.keys, images)
        return asyncio.run(room.run(plan, way, text, options.for_s, options.json))


def show(names: list[str], as_json: bool) -> int:
    """What nodes say of themselves; 1 if nobody was named and some do not answer."""
    sockets = [status.find(name) for name in names] if names else status.sockets()
    if not sockets:
        where = f"no node runs here (folder {status.where()})"
        raise errors.UserError(f"{where}; start one with: innervate live node FILE")
    told, silent = [], []
    for path in sockets:
        try:
            told.append(status.ask_one(path, {"do": "status"}))
        except LiveError:
            if names:
                raise
            silent.append(path)
    if as_json:
        print(json.dumps(told if len(told) != 1 or not names else told[0]))
    else:
        if not names:
            print(live_status.headline(told, silent))
        for one in told:
            for line in live_status.lines(one):
                print(line)
        for line in (*live_status.twins(told), *live_status.broken(told)):
            print(line)
    for path in silent:
        print(f"{path.stem}: does not answer; its process was killed, or hangs", file=sys.stderr)
    return 1 if silent else 0


def send(name: str, to: int, text: str, how: dict[str, bool], as_json: bool) -> int:
    """Send a message; 0 if it was delivered, or only accepted where no receipt is asked for."""
    where = status.find(name)
    payload = _read() if text == "-" else text.encode(errors="surrogateescape")
    request = {"do": "send", "to": to, "payload": payload.hex(), **how,
               "wait": how["reliable"] and to != ALL}  # fmt: skip
    state = "refused"
    for answer in status.ask(where, request):
        state = answer["state"]
        reason = f": {answer['reason']}" if answer["reason"] else ""
        print(json.dumps(answer) if as_json else f"{state}{reason}", flush=True)
        if state in FINAL or not request["wait"]:
            break
    return 0 if state == "delivered" or (state == "accepted" and not request["wait"]) else 1


def _read() -> bytes:
    """All of standard input.

    Raises:
        UserError: there is none.
    """
    if sys.stdin is None:
        raise errors.UserError("- reads standard input, which is closed")
    return sys.stdin.buffer.read()


def listen(name: str, count: int, in_order: bool, as_json: bool) -> int:
    """Print messages that come in at a node."""
    if count < 0:
        raise errors.UserError(f"--count must be a whole number from 0, not {count}")
    heard, where = 0, status.find(name)
    words = known(status.ask_one(where, {"do": "status"})["kind"]).live_words
    request = {"do": "listen", "alarms": True, **({"in_order": True} if in_order else {})}
    for answer in status.ask(where, request):
        if "missed" in answer:
            print(f"{answer['missed']} missed here: they were not read in time", file=sys.stderr)
        if "from" not in answer:
            continue
        if as_json:
            print(json.dumps(answer), flush=True)
        else:
            print(f"{answer['from']}: {words.heard(answer)}", flush=True)
        heard += 1
        if heard == count:
            break
    return 0


def command(name: str, code: int, value: int, cell: int | None, as_json: bool) -> int:
    """Have the PC of a skin send a command down; 0 if somebody was there to hand it down."""
    request = {"do": "command", "code": code, "value": value, "cell": cell}
    sent = status.ask_one(status.find(name), request)
    if as_json:
        print(json.dumps(sent))
    elif sent["ports"]:
        whom = "all cells" if cell is None else f"cell {cell}"
        ports = f"{sent['ports']} interface port{'s' if sent['ports'] > 1 else ''}"
        print(f"command {sent['number']} to {whom}, by {ports}")
    else:
        print("nobody is there to hand it down: no cell has the PC as its parent", file=sys.stderr)
    if not sent.get("checked", True):
        why = "the PC's file does not say how many numbers there are; add nodes ="
        print(f"nobody knows whether there is a cell {cell}: {why}", file=sys.stderr)
    return 0 if sent["ports"] else 1


def change(name: str, port: int, what: str) -> int:
    """Cut or restore a cable at one node."""
    status.ask_one(status.find(name), {"do": what, "port": port})
    return 0
