"""`innervate live`: its commands and their options."""

from pathlib import Path
from typing import Annotated

from cyclopts import App, Parameter

from innervate.cli import errors
from innervate.cli.options import Engine, Flag, SendOptions, UpOptions, Whole

Text = Annotated[str, Parameter(allow_leading_hyphen=True)]
live_app = App(
    name="live",
    help="Nodes between real processes: UDP, serial ports.",
    help_format="plaintext",
)


@live_app.command(name="node")
def live_node(
    file: Path,
    /,
    *,
    engine: Engine | None = None,
    firmware: Path | None = None,
) -> int:
    """Run one node until SIGTERM or Ctrl-C; SIGHUP reads its keys again.

    Args:
        file: A node file (see: innervate docs live).
        engine: What runs its protocol here, in place of what the file says; auto: C where it can be
            made.
        firmware: What runs its protocol, on an emulated board: an image (see: innervate docs
            firmware).
    """
    from innervate.live.main import run as command

    if firmware is None:
        return command(file, engine=engine or "")
    if engine is not None:
        raise errors.UserError("--engine and --firmware exclude each other; name one")
    from innervate.cli.firmware import engine_for

    return command(file, engine_for(file, firmware), "python")


@live_app.command(name="up")
def live_up(
    file: str,
    /,
    *,
    options: Annotated[UpOptions, Parameter(name="*")] = UpOptions(),
) -> int:
    """Bring a scenario up, a process for every node, and play its events, until Ctrl-C.

    Args:
        file: A scenario, or the name of a bundled one.
    """
    from innervate.cli import live as command

    if options.netns and options.pty:
        raise errors.UserError("--netns and --pty exclude each other; name one")
    errors.check_seconds("--for", options.for_s)
    if options.sealed and options.identities:
        raise errors.UserError("--sealed and --identities exclude each other; name one")
    return command.up(file, options)


@live_app.command(name="status")
def live_status(*nodes: str, json: Flag = False) -> int:
    """Show neighbours, routes, counters, broken cables of running nodes.

    Args:
        nodes: Names or sockets; all nodes of this user if left out.
        json: Print JSON.
    """
    from innervate.cli import live as command

    return command.show(list(nodes), json)


@live_app.command(name="send")
def live_send(
    node: str,
    to: Whole,
    text: Text,
    /,
    *,
    how: Annotated[SendOptions, Parameter(name="*")] = SendOptions(),
    json: Flag = False,
) -> int:
    """Send a message from a running node; prints what becomes of it.

    Args:
        node: Name or socket of the node that sends.
        to: Number of the recipient; 255 all, 254 the monitor.
        text: The message; - reads standard input.
        json: Print JSON lines.
    """
    from innervate.cli import live as command

    return command.send(node, to, text, how.asked, json)


@live_app.command(name="command")
def live_command(
    node: str,
    code: Whole,
    value: Whole = 0,
    /,
    *,
    cell: Whole | None = None,
    json: Flag = False,
) -> int:
    """Have the PC of a skin send a command down to its cells, over the children of every cell.

    Args:
        node: Name or socket of the PC.
        code: What to do, 0 to 255; your cells know what it means.
        value: With what, 0 to 65535.
        cell: Number of the cell it is for; all cells if left out.
        json: Print JSON.
    """
    from innervate.cli import live as room

    return room.command(node, code, value, cell, json)


@live_app.command(name="listen")
def live_listen(node: str, /, *, count: int = 0, in_order: Flag = False, json: Flag = False) -> int:
    """Print what comes in at a running node, until Ctrl-C: messages, samples, commands.

    Args:
        node: Name or socket.
        count: End after so many; 0 = never.
        in_order: Each sender's messages as it sent them, where it sent them in order.
        json: Print JSON lines.
    """
    from innervate.cli import live as command

    return command.listen(node, count, in_order, json)


@live_app.command(name="capture")
def live_capture(
    *nodes: str,
    out: Path | None = None,
    for_: Annotated[float, Parameter(name=["--for"])] = 0.0,
) -> int:
    """Write frames of running nodes to a capture for Wireshark, until Ctrl-C.

    Args:
        nodes: Names or sockets; all nodes of this user if left out.
        out: The capture; it can be read while it grows. Standard output if left out.
        for_: End after so many seconds; 0 = never.
    """
    from innervate.cli import capturing as command

    errors.check_seconds("--for", for_)
    return command.capture(list(nodes), out, for_)


@live_app.command(name="recovery")
def live_recovery(capture: Path, /, *, json: Flag = False) -> int:
    """Say how a skin healed, from a capture of all its nodes: when routes and samples were back.

    Args:
        capture: What `live capture --out` wrote; or `export --pcapng` of a run.
        json: Print JSON.
    """
    from innervate.cli import live_recovery as command

    return command.show(capture, json)


@live_app.command(name="medium")
def live_medium(
    address: str = "127.0.0.1:4600",
    /,
    *,
    slot_us: Whole = 10_000,
    turnaround_us: Whole = 5_000,
) -> int:
    """Run a radio channel: stations whose files name its address hear each other on it.

    Args:
        address: Where stations find it.
        slot_us: Time of a slot on the air.
        turnaround_us: From deciding to send to being on the air, and back.
    """
    import asyncio

    from innervate.live import channel

    asyncio.run(channel.run(address, slot_us, turnaround_us))
    return 0


@live_app.command(name="modem")
def live_modem(
    device: str,
    address: str = "127.0.0.1:4600",
    /,
    *,
    number: Whole = 0,
    baud: Whole = 1_000_000,
) -> int:
    """Put a board at a serial line on a radio channel of `live medium`, as one of its stations.

    Args:
        device: The serial port, like /dev/ttyUSB0.
        address: Where the channel is.
        number: The board's, as its firmware has it.
        baud: Bits per second.
    """
    import asyncio

    from innervate.live import modem

    asyncio.run(modem.run(device, baud, number, address))
    return 0


@live_app.command(name="enrol")
def live_enrol(folder: Path, /, *numbers: int, nodes: int = 0) -> int:
    """Make an identity for each node of a network: one file for each, which is all that it needs.

    Args:
        folder: Of the network's authority; made if it is not there. Its authority.key stays with
            you.
        numbers: Of the nodes.
        nodes: Those with numbers 0 to nodes - 1, besides.
    """
    from innervate.cli import live_enrol as command

    return command.enrol(folder, list(numbers), nodes)


@live_app.command(name="revoke")
def live_revoke(where: Path, /, *numbers: int, json: Flag = False) -> int:
    """Put nodes out whose identity has leaked; running nodes are told and tell each other.

    Args:
        where: The authority's folder; or a revoked.list from it, to tell nodes on this machine.
        numbers: Of the nodes; none tells of the list as it is.
        json: Print JSON.
    """
    from innervate.cli import live_enrol as command

    return command.revoke(where, list(numbers), json)


@live_app.command(name="cut")
def live_cut(node: str, port: int, /, *, restore: Flag = False) -> int:
    """Cut a cable in silence at one end, as if its plug had come out; or put it back.

    Args:
        node: Name or socket.
        port: Number of the path, as status shows it.
        restore: Put it back.
    """
    from innervate.cli import live as command

    return command.change(node, port, "restore" if restore else "cut")
