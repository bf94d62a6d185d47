"""What a protocol in C needs besides its functions: Python's arithmetic, how records begin."""

from __future__ import annotations

from typing import NamedTuple

from innervate.firmware.records import Field, initial, name_of


class Helper(NamedTuple):
    """A function in C; {p} is the prefix, {P} the same in capitals."""

    text: str
    needs: tuple[str, ...] = ()


HELPERS = {
    "min": Helper("""\
static int32_t {p}_min(int32_t a, int32_t b)
{{
    return a < b ? a : b;
}}
"""),
    "max": Helper("""\
static int32_t {p}_max(int32_t a, int32_t b)
{{
    return a > b ? a : b;
}}
"""),
    "abs": Helper("""\
static int32_t {p}_abs(int32_t a)
{{
    return a < 0 ? -a : a;
}}
"""),
    "floor_div": Helper("""\
/* Rounds down, where `/` of C rounds towards 0; divides without signs, as all the rest. */
static int32_t {p}_floor_div(int32_t a, int32_t b)
{{
    if (b < 0) {{
        a = -a;
        b = -b;
    }}
    if (a < 0) {{
        return -1 - (int32_t)((uint32_t)(-1 - a) / (uint32_t)b);
    }}
    return (int32_t)((uint32_t)a / (uint32_t)b);
}}
"""),
    "floor_mod": Helper(
        """\
/* What is left of a behind floor_div: never negative where b is not. */
static int32_t {p}_floor_mod(int32_t a, int32_t b)
{{
    return a - {p}_floor_div(a, b) * b;
}}
""",
        ("floor_div",),
    ),
}

# Declarations of what no function of the protocol does.
PUBLIC = """\
/** Parameters as the network's plainest scenario has them, or as they were given. */
extern const {p}_params_t {p}_defaults;

/** A state before its first start: all fields as declared; number says who it is, seed (1 to
 * 1072496638, on every node another, not near each other) begins its random choices. */
void {p}_init({p}_state_t *state, int32_t number, int32_t seed);

/** Empties an outbox, after its actions are carried out and before its first use. */
void {p}_clear({p}_out_t *out);
"""
FRAME_OF = """\
/** The frame of a SEND or DELIVER; 0 if it has none. */
const {p}_frame_t *{p}_frame_of(const {p}_out_t *out, int32_t action);
"""
INIT_GATE = """\
/** The second record before the first start. */
void {p}_init_gate({p}_gate_t *gate);
"""


def public(prefix: str, records: dict[str, dict[str, Field]]) -> str:
    """Declarations of what no function of the protocol does."""
    parts = [PUBLIC]
    if "frame" in records:
        parts.append(FRAME_OF)
    if "gate" in records:
        parts.append(INIT_GATE)
    return "\n".join(part.format(p=prefix) for part in parts)


def own(prefix: str, records: dict[str, dict[str, Field]]) -> str:
    """Definitions of what `public` declares."""
    parts = [_zero(prefix), _init(prefix, "state", records["state"])]
    if "gate" in records:
        parts.append(_init(prefix, "gate", records["gate"]))
    return "\n".join(parts)


def _zero(prefix: str) -> str:
    return f"""\
static void {prefix}_zero(void *record, uint32_t size)
{{
    for (uint32_t i = 0; i < size; i++) {{
        ((uint8_t *)record)[i] = 0;
    }}
}}
"""


def _init(prefix: str, record: str, fields: dict[str, Field]) -> str:
    """A function that sets a record's fields to what they begin with."""
    is_state = record == "state"
    own = {"number": "number", "rng": "seed", "choice": "-1"} if is_state else {}
    name = f"{prefix}_init" if is_state else f"{prefix}_init_{record}"
    more = ", int32_t number, int32_t seed" if is_state else ""
    lines = [f"void {name}({prefix}_{record}_t *{record}{more})", "{"]
    if is_state:
        lines += [f"    (void){argument};" for field, argument in own.items()
                  if field not in fields and argument.isalpha()]  # fmt: skip
    lines.append(f"    {prefix}_zero({record}, (uint32_t)sizeof *{record});")
    for field in fields.values():
        value = own.get(field.name, str(initial(field)))
        place = f"{record}->{name_of(field.name)}"
        if value == "0":
            continue
        if value.isalpha() and field.type != "int32_t":
            value = f"({field.type}){value}"
        if field.length:
            lines += [f"    for (int32_t i = 0; i < {field.length}; i++) {{",
                      f"        {place}[i] = {value};", "    }"]  # fmt: skip
        else:
            lines.append(f"    {place} = {value};")
    return "\n".join([*lines, "}"]) + "\n"
