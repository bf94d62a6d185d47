"""A Wireshark dissector in Lua, generated from the layouts of `wire`; dissector.lua runs them."""

from __future__ import annotations

import os
from importlib.resources import files as resources
from pathlib import Path
from typing import Any

import innervate
from innervate.export import files
from innervate.export.errors import ExportError
from innervate.networks.mesh import frames as mesh
from innervate.networks.mesh import payloads as mesh_payloads
from innervate.networks.mesh.meanings import MEANINGS
from innervate.networks.mesh.protocol import constants as mesh_words
from innervate.networks.mesh.protocol import fields as mesh_fields
from innervate.networks.radio import frames as radio
from innervate.networks.radio.protocol import fields as radio_fields
from innervate.networks.radio.protocol.constants import CRR, REPORT
from innervate.networks.skin import frames as skin
from innervate.networks.skin.protocol import fields as skin_fields
from innervate.wire import layout, seal

FILE = "innervate.lua"
FLAGS = (
    (mesh_words.ACK_WANTED, "ack wanted"),
    (mesh_words.END_TO_END, "end-to-end ack"),
    (mesh_words.FLOOD, "flood"),
    (mesh_words.SOURCE_ROUTE, "source route"),
    (mesh_words.DETOURED, "detoured"),
    (mesh_words.PRIORITY, "priority"),
    (mesh_words.FIRST, "first after boot"),
    (mesh_words.PARITY, "parity of the retry"),
)


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
    try:
        target.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise ExportError(f"{target}: {error.strerror}; name another folder") from None
    files.write_text(target / FILE, source())
    return target / FILE


def source() -> str:
    """The dissector."""
    runtime = (resources("innervate.export") / "dissector.lua").read_text(encoding="utf-8")
    head = f"-- Frames of innervate {innervate.__version__}: skin, mesh, radio. Generated: "
    head += "`innervate export --dissector` writes it anew."
    return "\n".join([head, *_constants(), "", _skin(), _mesh(), _radio(), "", runtime])


def _constants() -> list[str]:
    numbers = {
        "REST": layout.REST,
        "SKIN_HEAD": skin.KIND_BITS,
        "SKIN_MIN": skin.CRC_BYTES + 1,
        "MESH_VERSION": mesh.VERSION,
        "MESH_ACK": mesh_words.ACK,
        "MESH_ACK_BYTES": mesh_words.ACK_BYTES,
        "MESH_PATH_MAX": mesh_words.PATH_MAX,
        "MESH_SOURCE_ROUTE": mesh_words.SOURCE_ROUTE,
        "MESH_DETOURED": mesh_words.DETOURED,
        "RADIO_VERSION": radio.VERSION,
        "RADIO_CARRIER": radio.CRR_BYTE,
        "RADIO_REPORT": REPORT,
        "SEALED_MARK": seal.MARK,
        "SEALED_MIN": seal.OVERHEAD_BYTES,
    }
    flags = ", ".join(f'{{{bit}, "{name}"}}' for bit, name in FLAGS)
    made = [f"local {name} = {value}" for name, value in numbers.items()]
    return [*made, f"local MESH_FLAGS = {{{flags}}}"]


def _skin() -> str:
    says = _meanings(skin_fields.FRAME)
    return f"local SKIN = {{ kinds = {_kinds(skin.LAYOUTS, says)} }}"


def _mesh() -> str:
    says = _meanings(mesh_fields.FRAME)
    return (
        f"local MESH = {{ kinds = {_kinds(mesh_payloads.LAYOUTS, MEANINGS)},\n"
        f'  others = {{[{mesh_words.ACK}] = "ack"}},\n'
        f"  common = {_fields(mesh.COMMON, says)},\n  ack = {_fields(mesh.HOP_ACK, says)} }}"
    )


def _radio() -> str:
    kinds = _kinds(radio.LAYOUTS, _meanings(radio_fields.FRAME))
    return f'local RADIO = {{ kinds = {kinds}, others = {{[{CRR}] = "CR-R or pulse"}} }}'


def _kinds(layouts: Any, says: dict[str, str]) -> str:
    parts = [
        f'  [{kind}] = {{name = "{name}", abbr = "{abbreviation(name)}", '
        f"fields = {_fields(fields, says)}}}"
        for kind, name, fields in layouts
    ]
    return "{\n" + ",\n".join(parts) + " }"


def abbreviation(name: str) -> str:
    """A name of a frame as it stands in display filters."""
    return name.replace("-", "_").replace(" ", "_")


def _fields(fields: Any, says: dict[str, str]) -> str:
    return "{\n" + ",\n".join(f"    {_field(field, says)}" for field in fields) + " }"


def _field(field: Any, says: dict[str, str]) -> str:
    name, many, bits, signed = field
    count = f'"{many}"' if isinstance(many, str) else many
    size = f"group = {_fields(bits, says)}" if isinstance(bits, tuple) else f"bits = {bits}"
    sign = ", signed = true" if signed else ""
    return f'{{name = "{name}", many = {count}, {size}{sign}, says = "{says.get(name, "")}"}}'


def _meanings(fields: Any) -> dict[str, str]:
    return {name: meaning for name, _length, _low, _high, _unit, meaning in fields}
