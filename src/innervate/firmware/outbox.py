"""The outbox in C: its struct, and where in it the frames of actions lie.

Frames are whole, each in a place of its own; or, where a role says how many bytes they have
together, one behind the other, none longer than what it has of its last array.
"""

from innervate.firmware.records import BYTES, Field, name_of
from innervate.firmware.texts import filled, shipped
from innervate.live.board import Role


class Outbox:
    """The texts of a role's outbox.

    Attributes:
        is_behind: its frames lie one behind the other.
        frames: how many there are at most, where they are whole.
        bytes: that they have together, where they lie one behind the other.
    """

    def __init__(self, prefix: str, role: Role, records: dict[str, dict[str, Field]]) -> None:
        frame = list(records.get("frame", {}).values())
        self.has_frames, self.is_behind = bool(frame), role.frame_bytes > 0
        self.frames = role.frames or role.room
        self.bytes = role.frame_bytes
        self.prefix, self.words = prefix, dict[str, str]()
        if self.is_behind:
            last, widest = frame[-1].name, max(BYTES[field.type] for field in frame)
            self.words = {"@last": name_of(last), "@used": name_of(role.counted[last]),
                          "@spare": str(widest - 1)}  # fmt: skip

    def text(self, part: str) -> str:
        """A part: "struct" for the header, "give" that gives frames out, "own" for the source."""
        own = {"frames", "behind" if self.is_behind else "whole"} if self.has_frames else set()
        text = shipped("made/outbox.c", self.prefix, frozenset({part, *own}))
        return filled(text, self.words)

    def size(self) -> str:
        """The line that says how large it is."""
        if self.is_behind:
            name, many, what = "FRAME_BYTES", self.bytes, "bytes of the frames of one call at most"
        else:
            name, many, what = "FRAMES", self.frames, "frames of one call at most"
        return f"#define {self.prefix.upper()}_{name} {many} /* {what} */"
