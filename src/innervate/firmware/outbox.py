"""The outbox in C: its struct, and where in it the frames of actions lie.

Frames are whole, each in a place of its own; or, where a role says how many bytes they have
together, one behind the other, none longer than what it has of its last array.
"""

from __future__ import annotations

from innervate.firmware.records import BYTES, Field, name_of
from innervate.live.board import Role

STRUCT = """\
/** The outbox: what a handler wants done, in this order. */
typedef struct {{
    uint8_t count; /* actions */
    uint8_t overflow; /* 1 = one did not fit: a broken invariant, stop */
{frames}    {p}_action_t action[{P}_OUTBOX];
}} {p}_out_t;
"""
WHOLE = """\
    uint8_t frames; /* how many are in use */
    uint8_t place[{P}_OUTBOX]; /* by action: its frame + 1; 0 none */
    {p}_frame_t frame[{P}_FRAMES];
"""
BEHIND = """\
    uint16_t newest; /* as in `place` */
    uint16_t place[{P}_OUTBOX]; /* by action: at which byte its frame begins, + 1; 0 none */
    union {{
        {p}_frame_t first;
        uint8_t bytes[{P}_FRAME_BYTES]; /* one behind the other, each up to where its
                                         * `{last}` is in use: copy none as a whole */
    }} frame;
"""
OF_WHOLE = """\
/* The frame of an action: one of few, given out when it is first asked for. */
static {p}_frame_t *{p}_frame({p}_out_t *out, int32_t action)
{{
    if (out->place[action] == 0) {{
        if (out->frames >= {P}_FRAMES) {{
            out->overflow = 1;
            return &out->frame[{P}_FRAMES - 1];
        }}
        out->frames++;
        out->place[action] = out->frames;
    }}
    return &out->frame[out->place[action] - 1];
}}
"""
OF_BEHIND = """\
static {p}_frame_t *{p}_frame_at({p}_out_t *out, int32_t place)
{{
    return ({p}_frame_t *)(void *)&out->frame.bytes[place - 1];
}}

/* The frame of an action. When it is first asked for, it begins behind what the newest has of its
 * `{last}`, to which nothing may be added from then on. */
static {p}_frame_t *{p}_frame({p}_out_t *out, int32_t action)
{{
    if (out->place[action] == 0) {{
        int32_t at = 0;
        if (out->newest > 0) {{
            const {p}_frame_t *newest = {p}_frame_at(out, out->newest);
            at = (int32_t)((const uint8_t *)&newest->{last}[newest->{used}] - out->frame.bytes);
            at = (at + {spare}) & ~{spare};
        }}
        if (at + (int32_t)sizeof({p}_frame_t) > {P}_FRAME_BYTES) {{
            out->overflow = 1;
            at = 0;
        }}
        out->newest = (uint16_t)(at + 1);
        out->place[action] = out->newest;
    }}
    return {p}_frame_at(out, out->place[action]);
}}
"""
CLEAR = """\
void {p}_clear({p}_out_t *out)
{{
    out->count = 0;
    out->overflow = 0;
{frames}}}
"""
CLEAR_FRAMES = """\
    out->{first} = 0;
    for (int32_t i = 0; i < {P}_OUTBOX; i++) {{
        out->place[i] = 0;
    }}
"""
FRAME_OF = """\
const {p}_frame_t *{p}_frame_of(const {p}_out_t *out, int32_t action)
{{
    return out->place[action] ? {frame} : 0;
}}
"""
FRAME_OF_WHOLE = "&out->frame[out->place[action] - 1]"
FRAME_OF_BEHIND = (
    "(const {p}_frame_t *)(const void *)\n            &out->frame.bytes[out->place[action] - 1]"
)


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
        self.words = {"p": prefix, "P": prefix.upper()}
        if self.is_behind:
            last, widest = frame[-1].name, max(BYTES[field.type] for field in frame)
            self.words |= {"last": name_of(last), "used": name_of(role.counted[last]),
                           "spare": str(widest - 1)}  # fmt: skip

    def _text(self, text: str, frames: str = "") -> str:
        return text.format(**self.words, frames=frames)

    def size(self) -> str:
        """The line that says how large it is."""
        if self.is_behind:
            name, many, what = "FRAME_BYTES", self.bytes, "bytes of the frames of one call at most"
        else:
            name, many, what = "FRAMES", self.frames, "frames of one call at most"
        return f"#define {self.words['P']}_{name} {many} /* {what} */"

    def struct(self) -> str:
        """The struct that the header declares."""
        frames = self._text(BEHIND if self.is_behind else WHOLE) if self.has_frames else ""
        return self._text(STRUCT, frames)

    def helper(self) -> str:
        """The function that gives frames out."""
        return self._text(OF_BEHIND if self.is_behind else OF_WHOLE)

    def functions(self) -> str:
        """Definitions of what the header declares."""
        if not self.has_frames:
            return self._text(CLEAR)
        first = "newest" if self.is_behind else "frames"
        clear = self._text(CLEAR, CLEAR_FRAMES.format(first=first, **self.words))
        frame = self._text(FRAME_OF_BEHIND if self.is_behind else FRAME_OF_WHOLE)
        return f"{clear}\n{FRAME_OF.format(frame=frame, **self.words)}"
