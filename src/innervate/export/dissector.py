"""A Wireshark dissector in Lua, generated from frame layouts; dissector.lua runs them.

What a network says of its frames is its part `dissector`; any network with frame layouts has one.
"""

import os
from collections.abc import Iterable, Mapping
from importlib.resources import files as resources
from pathlib import Path
from typing import Any, NamedTuple

import innervate
from innervate.export import files
from innervate.export.errors import ExportError
from innervate.network import Network, networks
from innervate.wire import layout, seal

FILE = "innervate.lua"
USER0 = 147  # the link type that Wireshark calls USER0


class Frames(NamedTuple):
    """What a dissector has to know of a network's frames."""

    # A Lua table: `kinds` by number, `others` that have a name and no fields, `bits` of the type
    # that a frame begins with, `common` and `ack` for frames with a header, `ends`: the fields that
    # say `from` whom `to` whom a frame is, and what there means `all`.
    layouts: str
    # Lua that says `local function run(self, tvb, tree)`, which reads a frame and returns its line,
    # source and destination; "" = a type, the type's fields and a CRC.
    run: str = ""
    constants: Mapping[str, Any] = {}  # numbers, texts or tables in Lua that `run` speaks of


def plugin_folder() -> Path:
    """Where Wireshark looks for a user's own Lua plugins."""
    if os.name == "nt":
        return Path(os.environ.get("APPDATA", "~")).expanduser() / "Wireshark" / "plugins"
    return Path("~/.local/lib/wireshark/plugins").expanduser()


def install(folder: Path | None = None) -> Path:
    """Write the dissector into a folder, Wireshark's own if none is given; the file comes back.

    Raises:
        ExportError: it cannot be written.
    """
    target = folder or plugin_folder()
    if target.is_file():
        what = "--dissector alone takes a folder; add --pcapng for a scenario's frames, too"
        raise ExportError(f"{target} is a file; {what}")
    try:
        target.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise ExportError(f"{target}: {error.strerror}; name another folder") from None
    files.write_text(target / FILE, source())
    return target / FILE


def source() -> str:
    """The Wireshark dissector of all networks' frames, as Lua.

    Raises:
        ExportError: two networks have one link type, by which Wireshark tells frames apart.
    """
    known = [one for one in networks().values() if one.has("dissector") or one.has("frames")]
    _check_link_types(known)
    head = f"-- Frames of innervate {innervate.__version__}: {', '.join(n.name for n in known)}. "
    head += "Generated: `innervate export --dissector` writes it anew."
    numbers = {
        "REST": layout.REST, "SEALED_MARK": seal.MARK, "SEALED_MIN": seal.OVERHEAD_BYTES,
        "SEALED_FRAME": seal.FRAME, "SEALED_LAST": seal.CONTROL,
        "SEALED_END": seal.FIRST + seal.KEYS
    }  # fmt: skip
    return "\n".join([head, *_locals(numbers), "", lua("innervate.export"), *map(_network, known)])


def _check_link_types(known: list[Network]) -> None:
    taken: dict[int, Network] = {}
    for network in known:
        other = taken.setdefault(network.link_type, network)
        if other is not network:
            free = sorted({*range(USER0, USER0 + 16)} - {one.link_type for one in known})
            raise ExportError(
                f"{other.name} and {network.name} both have link_type {network.link_type}; give "
                f"one of them another in its network.py: {', '.join(map(str, free))}"
            )


def lua(package: str) -> str:
    """The file dissector.lua of a package."""
    return (resources(package) / "dissector.lua").read_text(encoding="utf-8")


def _network(network: Network) -> str:
    """A network's frames, in a block of their own."""
    said = network.dissector() if network.has("dissector") else usual(network)
    run = "run" if said.run else "nil"
    encap = f"encaps.USER{network.link_type - USER0}"
    define = f'define("{network.name}", {encap}, {run}, {said.layouts})'
    return "\n".join(["do", *_locals(said.constants), said.run, define, "end", ""])


def _locals(constants: Mapping[str, Any]) -> list[str]:
    return [f"local {name} = {value}" for name, value in constants.items()]


def usual(network: Network) -> Frames:
    """Of a network whose frames are a type, the type's fields and a CRC."""
    says = meanings(network.fields.FRAME)
    made = kinds(network.frames.LAYOUTS, says)
    ends = ""
    if hasattr(network.frames, "ENDS"):
        ends = 'ends = {{ from = "{}", to = "{}", all = {} }}, '.format(*network.frames.ENDS)
    return Frames(f"{{ bits = {network.frames.KIND_BITS}, {ends}kinds = {made} }}")


def kinds(layouts: Iterable[tuple[int, str, Any]], says: Mapping[str, str]) -> str:
    """A Lua table of frames by type, from (type, name, fields)."""
    parts = [
        f'  [{kind}] = {{name = "{name}", abbr = "{abbreviation(name)}", '
        f"fields = {fields_of(fields, says)}}}"
        for kind, name, fields in layouts
    ]
    return "{\n" + ",\n".join(parts) + " }"


def abbreviation(name: str) -> str:
    """A name of a frame as it stands in display filters."""
    return name.replace("-", "_").replace(" ", "_")


def fields_of(fields: Any, says: Mapping[str, str]) -> str:
    """A Lua list of fields as wire/layout.py has them; `says` what they mean, by name."""
    return "{\n" + ",\n".join(f"    {_field(field, says)}" for field in fields) + " }"


def _field(field: Any, says: Mapping[str, str]) -> str:
    name, many, bits, signed = field
    count = f'"{many}"' if isinstance(many, str) else many
    size = f"group = {fields_of(bits, says)}" if isinstance(bits, tuple) else f"bits = {bits}"
    sign = ", signed = true" if signed else ""
    return f'{{name = "{name}", many = {count}, {size}{sign}, says = "{says.get(name, "")}"}}'


def meanings(fields: Any) -> dict[str, str]:
    """What fields mean, by name, from their declarations in a protocol."""
    return {name: meaning for name, _length, _low, _high, _unit, meaning in fields}
