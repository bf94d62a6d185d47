"""What a protocol in C needs besides its functions: Python's arithmetic, how records begin."""

from innervate.firmware.records import Field, initial, name_of
from innervate.firmware.texts import shipped

# Functions of c/made/helpers.c, in their order, and which of them each needs.
HELPERS: dict[str, tuple[str, ...]] = {
    "min": (), "max": (), "abs": (), "floor_div": (), "floor_mod": ("floor_div",),
}  # fmt: skip


def own(prefix: str, records: dict[str, dict[str, Field]]) -> str:
    """Definitions of what made/public.h declares: what no function of the protocol does."""
    zero = shipped("made/helpers.c", prefix, frozenset({"zero"}))
    parts = [zero, _init(prefix, "state", records["state"])]
    if "gate" in records:
        parts.append(_init(prefix, "gate", records["gate"]))
    return "\n".join(parts)


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
