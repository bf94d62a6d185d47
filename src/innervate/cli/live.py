"""`innervate live`: nodes between real processes."""

from __future__ import annotations

import asyncio
import json
import sys
import tempfile
from pathlib import Path
from typing import Annotated

from cyclopts import Parameter

from innervate.cli import errors, live_status
from innervate.cli.options import Engine, Flag, Json, SendOptions, UpOptions, Whole
from innervate.kernel.words import number_of
from innervate.live import status
from innervate.live.errors import LiveError
from innervate.live.receipts import ALL, FINAL
from innervate.network import known

Text = Annotated[str, Parameter(allow_leading_hyphen=True)]


def node(file: Path, /, *, engine: Engine | None = None, firmware: Path | None = None) -> int:
    """Run one node.

    Args:
        file: A node file (see: innervate docs live).
        engine: What runs its protocol here, in place of what the file says; auto: C where it can be
            made.
        firmware: What runs its protocol, on an emulated board: an image (see: innervate docs
            firmware).
    """
    from innervate.live.main import run

    if firmware is None:
        return run(file, engine=engine or "")
    if engine is not None:
        raise errors.UserError("--engine and --firmware exclude each other; name one")
    from innervate.cli.firmware import engine_for

    return run(file, engine_for(file, firmware), "python")


def up(file: str, /, *, options: Annotated[UpOptions, Parameter(name="*")] = UpOptions()) -> int:
    """Bring a scenario up as processes.

    Args:
        file: A scenario, or the name of a bundled one.
        options: How it is brought up.
    """
    if options.netns and options.pty:
        raise errors.UserError("--netns and --pty exclude each other; name one")
    errors.check_seconds("--for", options.for_s)
    if options.sealed and options.identities:
        raise errors.UserError("--sealed and --identities exclude each other; name one")
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


def show(*nodes: str, as_json: Json = False) -> int:
    """What nodes say of themselves; 1 if nobody was named and some do not answer.

    Args:
        nodes: Names or sockets; all nodes of this user if left out.
        as_json: Print JSON.
    """
    told, silent = [], []
    paths = live_status.sockets(nodes)
    for path, answer in zip(paths, status.ask_all(paths, {"do": "status"}), strict=True):
        if not isinstance(answer, LiveError):
            told.append(answer)
        elif nodes:
            raise answer
        else:
            silent.append(path)
    if as_json:
        print(json.dumps(told if len(told) != 1 or not nodes else told[0]))
    else:
        if not nodes:
            print(live_status.headline(told, silent))
        for one in told:
            for line in live_status.lines(one):
                print(line)
        for line in (*live_status.twins(told), *live_status.broken(told)):
            print(line)
    for one in told:
        if not nodes and "file" in one and not Path(one["file"]).exists():
            why = "is gone; nodes that died since then may not be counted"
            print(f"{one['name']}: {one['file']} {why}", file=sys.stderr)
    for path in silent:
        print(f"{path.stem}: does not answer; its process was killed, or hangs", file=sys.stderr)
    return 1 if silent else 0


def send(
    node: str,
    to: Whole,
    text: Text,
    /,
    *,
    how: Annotated[SendOptions, Parameter(name="*")] = SendOptions(),
    as_json: Json = False,
) -> int:
    """Send a message; 0 if it was delivered, or only accepted where no receipt is asked for.

    Args:
        node: Name or socket of the node that sends.
        to: Number of the recipient; 255 all, 254 the monitor.
        text: The message; - reads standard input.
        how: How it is sent.
        as_json: Print JSON lines.
    """
    where = status.find(node)
    payload = _read() if text == "-" else text.encode(errors="surrogateescape")
    request = {"do": "send", "to": to, "payload": payload.hex(), **how.asked,
               "wait": how.reliable and to != ALL}  # fmt: skip
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


def listen(node: str, /, *, count: int = 0, in_order: Flag = False, as_json: Json = False) -> int:
    """Print messages that come in at a node.

    Args:
        node: Name or socket.
        count: End after so many; 0 = never.
        in_order: Each sender's messages as it sent them, where it sent them in order.
        as_json: Print JSON lines.
    """
    if count < 0:
        raise errors.UserError(f"--count must be a whole number from 0, not {count}")
    heard, where = 0, status.find(node)
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


def command(
    node: str, code: Whole, value: Whole = 0, /, *, cell: Whole | None = None, as_json: Json = False
) -> int:
    """Have the PC of a skin send a command down; 0 if somebody was there to hand it down.

    Args:
        node: Name or socket of the PC.
        code: What to do, 0 to 255; your cells know what it means.
        value: With what, 0 to 65535.
        cell: Number of the cell it is for; all cells if left out.
        as_json: Print JSON.
    """
    request = {"do": "command", "code": code, "value": value, "cell": cell}
    sent = status.ask_one(status.find(node), request)
    if as_json:
        print(json.dumps(sent))
    elif sent["ports"]:
        whom = "all cells" if cell is None else f"cell {cell}"
        ports = number_of(sent["ports"], "interface port")
        print(f"command {sent['number']} to {whom}, by {ports}")
    else:
        print("nobody is there to hand it down: no cell has the PC as its parent", file=sys.stderr)
    if not sent.get("checked", True):
        why = "the PC's file does not say how many numbers there are; add nodes ="
        print(f"nobody knows whether there is a cell {cell}: {why}", file=sys.stderr)
    return 0 if sent["ports"] else 1


def change(node: str, port: int, /, *, restore: Flag = False) -> int:
    """Cut or restore a cable at one node.

    Args:
        node: Name or socket.
        port: Number of the path, as status shows it.
        restore: Put it back.
    """
    status.ask_one(status.find(node), {"do": "restore" if restore else "cut", "port": port})
    return 0


def medium(
    address: str = "127.0.0.1:4600", /, *, slot_us: Whole = 10_000, turnaround_us: Whole = 5_000
) -> int:
    """Run a radio channel until it is ended.

    Args:
        address: Where stations find it.
        slot_us: Time of a slot on the air.
        turnaround_us: From deciding to send to being on the air, and back.
    """
    from innervate.live import channel

    asyncio.run(channel.run(address, slot_us, turnaround_us))
    return 0


def modem(
    device: str, address: str = "127.0.0.1:4600", /, *, number: Whole = 0, baud: Whole = 1_000_000
) -> int:
    """Put a board on a radio channel until it is ended.

    Args:
        device: The serial port, like /dev/ttyUSB0.
        address: Where the channel is.
        number: The board's, as its firmware has it.
        baud: Bits per second.
    """
    from innervate.live import modem as room

    asyncio.run(room.run(device, baud, number, address))
    return 0
