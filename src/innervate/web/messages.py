"""What a page may send: every command with its fields, checked before anything is done."""

import math
from typing import Annotated, get_args

import msgspec

from innervate.web.errors import Refused

LENGTH_MAX = 4096

Number = Annotated[int, msgspec.Meta(ge=0, le=100_000_000)]
Level = Annotated[int, msgspec.Meta(ge=0, le=255)]
Seconds = Annotated[float, msgspec.Meta(ge=0, le=1e9)]


class _Command(msgspec.Struct, frozen=True, tag_field="do", forbid_unknown_fields=True):
    """What a page may ask for; the tag is its `do`."""


class Cut(_Command, frozen=True, tag="cut"):
    """Cut a link, by its number in the scene."""

    link: Number


class Heal(_Command, frozen=True, tag="heal"):
    """Put a link back, by its number in the scene."""

    link: Number


class Kill(_Command, frozen=True, tag="kill"):
    """Switch a node off without warning."""

    node: Number


class Revive(_Command, frozen=True, tag="revive"):
    """Switch a node on again."""

    node: Number


class Touch(_Command, frozen=True, tag="touch"):
    """Touch a cell: 1 .. 255 presses it, 0 lets go."""

    node: Number
    value: Level


class Give(_Command, frozen=True, tag="command"):
    """Have the PC of a skin send a command to a cell, or (without node) to all."""

    code: Level
    value: Annotated[int, msgspec.Meta(ge=0, le=65_535)] = 0
    node: Number | None = None


class Pause(_Command, frozen=True, tag="pause"):
    """Stop the network's time until Go."""


class Go(_Command, frozen=True, tag="go"):
    """Let the network's time go on."""


class Step(_Command, frozen=True, tag="step"):
    """Have one event happen, then hold."""


class Speed(_Command, frozen=True, tag="speed"):
    """Seconds of the network per second of the page; 0 = as fast as possible."""

    value: float


class Seek(_Command, frozen=True, tag="seek"):
    """Go to a moment of the network's time."""

    t_s: Seconds


class Save(_Command, frozen=True, tag="save"):
    """Give back the scenario with all that was done to it as events."""


Command = Cut | Heal | Kill | Revive | Touch | Give | Pause | Go | Step | Speed | Seek | Save
NAMES = ", ".join(str(one.__struct_config__.tag) for one in get_args(Command))
_DECODER = msgspec.json.Decoder(Command)


def name_of(command: Command) -> str:
    """What a command is called in a scene's `can`."""
    name = str(command.__struct_config__.tag)
    return "pause" if name == "go" else name


def parse(text: str | bytes) -> Command:
    """The command in a message.

    Raises:
        Refused: it is none.
    """
    if len(text) > LENGTH_MAX:
        raise Refused("a command has at most 4096 characters")
    try:
        command: Command = _DECODER.decode(text)
    except (msgspec.DecodeError, UnicodeError, RecursionError) as error:
        why = str(error).splitlines()[0][:200] if str(error) else "it cannot be read"
        raise Refused(f'not a command, {{"do": one of {NAMES}, ...}}: {why}') from None
    for field in command.__struct_fields__:
        value = getattr(command, field)
        if isinstance(value, float) and not math.isfinite(value):
            raise Refused(f"{field} must be a finite number")
    return command


def number(kind: str, given: int, count: int) -> int:
    """A number of a link or node that is there.

    Raises:
        Refused: there is none.
    """
    if not 0 <= given < count:
        raise Refused(f"there is no {kind} {given}; they are numbered 0 to {count - 1}")
    return given
