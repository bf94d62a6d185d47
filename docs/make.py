"""Makes what is generated in the documentation: tables of declared fields, the picture.

`python docs/make.py` writes them; with `--check` it only says which tables are out of date, and
ends with exit code 1 if one is.
"""

from __future__ import annotations

import sys
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from msgspec import structs

from innervate.networks import models
from innervate.networks.mesh import frames as mesh
from innervate.networks.mesh import papers as mesh_papers
from innervate.networks.mesh import payloads as mesh_payloads
from innervate.networks.mesh import tables as mesh_tables
from innervate.networks.mesh.meanings import MEANINGS
from innervate.networks.mesh.protocol import fields as mesh_fields
from innervate.networks.radio import frames as radio
from innervate.networks.radio import papers as radio_papers
from innervate.networks.radio import tables as radio_tables
from innervate.networks.radio.protocol import fields as radio_fields
from innervate.networks.skin import frames as skin
from innervate.networks.skin import papers as skin_papers
from innervate.networks.skin.protocol import fields as skin_fields
from innervate.networks.skin.tables import TABLES
from innervate.scenario.keys import Table
from innervate.trace import tables
from innervate.wire import layout

FOLDER = Path(__file__).resolve().parent
PICTURES = {name: FOLDER / "images" / f"{name}.svg" for name in ("recovery", "radio", "mesh")}
MESH_CLASS = 32  # nodes: the smallest capacity class


def field_table(fields: Iterable[tuple[str, object, int, int, str, str]]) -> str:
    """Declared fields of a protocol as a Markdown table."""
    rows = ["| field | range | unit | meaning |", "|---|---|---|---|"]
    for name, length, low, high, unit, meaning in fields:
        many = {0: "", "ports": " per port"}.get(length, f", {length} of them")  # type: ignore[call-overload]
        rows.append(f"| `{name}` | {low} .. {high}{many} | {unit} | {meaning} |")
    return "\n".join(rows)


def reading_table(readings: dict[str, str]) -> str:
    """Labels of readings and their sentences as a Markdown table."""
    rows = [f"| {label} | {_cell(sentence)} |" for label, sentence in readings.items()]
    return "\n".join(["| label | what it says |", "|---|---|", *rows])


def _cell(text: str) -> str:
    return text.replace("*", "\\*").replace("|", "\\|").replace("_", "\\_")


def run_tables(given: Iterable[tables.Table]) -> str:
    """The tables of a run folder as Markdown."""
    parts = []
    for table in given:
        rows = [f"**`{table.name}.parquet`**: one row where {table.row}.", ""]
        rows += ["| column | type | unit | meaning |", "|---|---|---|---|"]
        rows += [f"| `{c.name}` | {c.kind} | {c.unit} | {c.meaning} |" for c in table.columns]
        parts.append("\n".join(rows))
    return "\n\n".join(parts)


def layout_rows(fields: Iterable[tuple[str, Any, Any, int]], says: dict[str, str]) -> list[str]:
    """Rows of a layout; those of a group are marked with what they are in."""
    rows = []
    for name, many, bits, signed in fields:
        how_many = {0: "", layout.REST: " each, to the end", layout.PAIRS: " per pair"}.get(
            many, f" x {many}" if isinstance(many, int) else f" each, `{many}` of them"
        )
        group = isinstance(bits, tuple)
        size = "group" if group else f"{bits}{', signed' if signed else ''}"
        shown = ("-", "spare") if name == layout.SPARE else (f"`{name}`", says[name])
        rows.append(f"| {shown[0]} | {size}{how_many} | {shown[1]} |")
        if group:
            inner = layout_rows(bits, says)
            rows += [row.replace("| `", f"| `{name}`: `", 1) for row in inner]
    return rows


def layout_table(fields: Iterable[tuple[str, Any, Any, int]], says: dict[str, str]) -> str:
    """A layout as a Markdown table."""
    return "\n".join(["| field | bits | meaning |", "|---|---|---|", *layout_rows(fields, says)])


def layout_tables(layouts: Iterable[tuple[int, str, Any]], says: dict[str, str]) -> str:
    """Several layouts, each under its name and type."""
    return "\n\n".join(
        f"**{name}**, type {kind}\n\n{layout_table(fields, says)}" for kind, name, fields in layouts
    )


def meanings(fields: Iterable[tuple[str, object, int, int, str, str]]) -> dict[str, str]:
    """What declared fields mean, by name."""
    return {name: meaning for name, _length, _low, _high, _unit, meaning in fields}


def mesh_frames() -> str:
    """The two forms of the mesh's frames."""
    says = meanings(mesh_fields.FRAME) | {
        "version": "1",
        "flags": "see above",
        "payload": "see below",
        "crc": "CRC-16 of all before it",
    }
    ack = says | {"rssi": "of the frame that this acknowledges, dBm", "seq": "of that frame",
                  "more": "other packets that came from the same hop"}  # fmt: skip
    return (
        f"**packet**\n\n{layout_table(mesh.PACKET, says)}\n\n"
        f"**ack of a hop**, type {mesh.ACK}\n\n{layout_table(mesh.WHOLE_ACK, ack)}"
    )


def model_table() -> str:
    """The classes that scenarios are built of in code, each with its keys, as Markdown."""
    rows = ["| class | what it is | keys |", "|---|---|---|"]
    for name in models.__all__:
        model = getattr(models, name)
        inner = {f"{name}.{called}": table for called, table in vars(model).items()
                 if isinstance(table, type) and issubclass(table, Table)}  # fmt: skip
        for called, table in {name: model, **inner}.items():
            says = _cell(str(table.__doc__).splitlines()[0].partition("; its tables")[0])
            keys = ", ".join(f"`{field.name}`" for field in structs.fields(table))
            rows.append(f"| `{called}` | {says} | {keys} |")
    return "\n".join(rows)


# (page, name of the part, how it is made)
PARTS = (
    ("api.md", "models", model_table),
    ("skin.md", "parameters", lambda: field_table(skin_fields.PARAMS)),
    ("skin.md", "frame", lambda: field_table(skin_fields.FRAME)),
    ("skin.md", "cell", lambda: field_table(skin_fields.CELL)),
    ("radio.md", "radio-parameters", lambda: field_table(radio_fields.PARAMS)),
    ("radio.md", "radio-frame", lambda: field_table(radio_fields.FRAME)),
    ("radio.md", "radio-station", lambda: field_table(radio_fields.STATION)),
    ("radio.md", "radio-practical", lambda: field_table(radio_fields.PRACTICAL)),
    ("mesh.md", "mesh-frame", lambda: field_table(mesh_fields.FRAME)),
    ("mesh.md", "mesh-parameters", lambda: field_table(mesh_fields.PARAMS)),
    ("mesh.md", "mesh-node", lambda: field_table(mesh_fields.node(MESH_CLASS))),
    ("mesh.md", "mesh-gate", lambda: field_table(mesh_fields.gate(MESH_CLASS))),
    ("wire.md", "wire-skin", lambda: layout_tables(skin.LAYOUTS, meanings(skin_fields.FRAME))),
    ("wire.md", "wire-mesh", mesh_frames),
    ("wire.md", "wire-mesh-payloads", lambda: layout_tables(mesh_payloads.LAYOUTS, MEANINGS)),
    ("wire.md", "wire-mesh-piece", lambda: layout_table(mesh_payloads.PIECE, MEANINGS)),
    ("wire.md", "wire-mesh-graph", lambda: layout_table(mesh_payloads.WHOLE_GRAPH, MEANINGS)),
    ("wire.md", "wire-radio", lambda: layout_tables(radio.LAYOUTS, meanings(radio_fields.FRAME))),
    ("reading-a-report.md", "tables", lambda: run_tables(TABLES)),
    ("reading-a-report.md", "radio-tables", lambda: run_tables(radio_tables.TABLES)),
    ("readings.md", "skin-readings", lambda: reading_table(skin_papers.READINGS)),
    ("readings.md", "radio-readings", lambda: reading_table(radio_papers.READINGS)),
    ("readings.md", "mesh-readings", lambda: reading_table(mesh_papers.READINGS)),
    ("reading-a-report.md", "mesh-tables", lambda: run_tables(mesh_tables.TABLES)),
)


def renewed(text: str, name: str, content: str) -> str:
    """A page with the part `name` replaced.

    Raises:
        ValueError: the page has no such part.
    """
    begin, end = f"<!-- {name}: made by docs/make.py -->", f"<!-- end of {name} -->"
    before, found, rest = text.partition(begin)
    _, closed, after = rest.partition(end)
    if not found or not closed:
        raise ValueError(f"there is no part {name}")
    return f"{before}{begin}\n{content}\n{end}{after}"


def pages() -> dict[Path, str]:
    """Every page with generated parts, as it should be."""
    made: dict[Path, str] = {}
    for page, name, make in PARTS:
        path = FOLDER / page
        text = made.get(path) or path.read_text(encoding="utf-8")
        made[path] = renewed(text, name, make())
    return made


def draw_recovery() -> None:
    """The README's picture: four moments of the bundled scenario `demo`."""
    import innervate
    from innervate.networks.skin.plot import map as skinmap
    from innervate.networks.skin.plot.digest import Digest
    from innervate.networks.skin.plot.report import legend
    from innervate.plot import svg, theme

    done = innervate.run("demo")
    story = Digest(done.result, done.summary)
    sheet = story.sheet
    step, head = sheet.width - 30, 46.0
    picture = svg.Drawing(
        4 * step + 30, sheet.height + head + 26, story.headline(story.incidents[0])
    )
    for i, (title, time_us) in enumerate(story.moments()):
        inner = skinmap.route_map(sheet, story.history.at(time_us), title, tips=False)
        picture.text((i * step + 28, 20), title, "strong")
        if i:
            after_ms = (time_us - story.incidents[0].at_us) / 1000
            when = f"{after_ms:.1f} ms after the cut" if after_ms else "at the cut"
            picture.text((i * step + 28, 38), when, "small")
        picture.place(inner, (i * step, head - 8))
    across = 28.0
    for icon, words in legend(story):
        picture.place(icon, (across, picture.height - 26))
        picture.text((across + 28, picture.height - 13), words)
        across += 7.4 * len(words) + 52
    picture.save(PICTURES["recovery"], theme.drawing_style())


def draw_radio() -> None:
    """The radio page's picture: a disaster of four stations, from the collision to the end."""
    import innervate
    from innervate.networks.radio.plot import timeline
    from innervate.networks.radio.plot.scene import scene
    from innervate.plot import theme

    done = innervate.run("radio-disaster", overrides={"stations": 4, "packet_slots": 12})
    timeline.draw(scene(done.result)).save(PICTURES["radio"], theme.drawing_style())


def draw_mesh() -> None:
    """The mesh page's picture: an alarm on its way round dead nodes."""
    import innervate
    from innervate.networks.mesh.analysis.alarms import all_crossings
    from innervate.networks.mesh.analysis.way import copies, way
    from innervate.networks.mesh.plot import map as mesh_map
    from innervate.networks.mesh.plot.report import shown_crossing
    from innervate.networks.mesh.plot.sheet import Sheet
    from innervate.plot import theme

    result = innervate.run(MESH_SCENARIO).result
    crossings = all_crossings(result)
    shown = shown_crossing(crossings)
    assert shown is not None
    sent, sheet = copies(result, shown), Sheet(result.plan, 680.0)
    title = "An alarm on its way round dead nodes"
    alarm = mesh_map.Alarmed(sent, way(result, shown, sent), shown.crossed_us)
    picture = mesh_map.field_map(result, sheet, title, crossings, alarm)
    picture.save(PICTURES["mesh"], theme.drawing_style())


# A robot leaves a fenced field while six of its relays are dead and nobody knows it yet.
MESH_SCENARIO = {
    "kind": "mesh",
    "name": "picture",
    "duration_s": 22.0,
    "seed": 3,
    "nodes": 32,
    "standby": [7],
    "monitor": 5,
    "fence": {
        "polygon": [[0, 0], [100, 0], [100, 100], [50, 85], [0, 100]],
        "holes": [[[40, 40], [60, 40], [60, 60], [40, 60]]],
    },
    "robot": [{"node": 29, "waypoints": [[80, 50], [105, 50]], "speed_mps": 2, "start_s": 10}],
    "event": [{"at_s": 19.9, "action": "kill", "random": 6}],
}


def main(arguments: list[str]) -> int:
    """Write everything, or with --check say what is out of date."""
    stale = [p for p, text in pages().items() if p.read_text(encoding="utf-8") != text]
    if "--check" in arguments:
        for path in stale:
            print(f"docs/{path.name} is out of date; run: python docs/make.py")
        return 1 if stale else 0
    for path, text in pages().items():
        path.write_text(text, encoding="utf-8")
    for draw in DRAWN.values():
        draw()
    return 0


DRAWN = {"recovery": draw_recovery, "radio": draw_radio, "mesh": draw_mesh}


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
