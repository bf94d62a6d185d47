"""A run as MCAP: every row of its tables, its states and its scene, as JSON with schemas."""

import heapq
import json
from collections.abc import Iterator, Mapping
from operator import itemgetter
from pathlib import Path
from typing import Any

import innervate
from innervate.export import files, scenes, schemas
from innervate.export.scenes import Channel, Message, stamp
from innervate.network import networks
from innervate.scenario.declared.shared import own_events

INFORMATION, WARNING = 2, 3


def write(plan: Any, found: Mapping[str, Any], path: Path) -> int:
    """Write a recording, whole or not at all, of a run's tables (polars); how many messages it has.

    Raises:
        ExportError: it cannot be written.
    """
    from mcap.writer import CompressionType, Writer

    count = 0
    with files.whole(path) as file:
        writer = Writer(file, compression=CompressionType.ZSTD)
        writer.start("innervate", f"innervate {innervate.__version__}")
        about = {"name": plan.scenario.name, "kind": plan.kind, "seed": str(plan.seed)}
        writer.add_metadata("innervate", about)
        streams = [
            _numbered(_register(writer, channel), channel.messages)
            for channel in channels(plan, found)
        ]
        for time_us, number, content in heapq.merge(*streams, key=lambda one: one[0]):
            data = json.dumps(content, separators=(",", ":")).encode()
            moment = 1000 * time_us
            writer.add_message(number, moment, data, moment)
            count += 1
        writer.finish()  # type: ignore[no-untyped-call]
    return count


def channels(plan: Any, found: Mapping[str, Any]) -> list[Channel]:
    """All channels of a run that have a message."""
    made = scenes.channels(plan, found)
    for table in networks()[plan.kind].tables:
        if table.name in found and len(found[table.name]):
            rows = _rows(found[table.name])
            topic = table.topic or f"/{table.name}"
            made.append(Channel(topic, schemas.of_table(table), rows))
    if plan.faults or own_events(plan):
        made.append(Channel("/log", schemas.LOG, events(plan)))
    return made


def _register(writer: Any, channel: Channel) -> int:
    data = json.dumps(channel.schema).encode()
    schema = writer.register_schema(channel.schema["title"], "jsonschema", data)
    number: int = writer.register_channel(channel.topic, "json", schema)
    return number


def _numbered(number: int, messages: Iterator[Message]) -> Iterator[tuple[int, int, Any]]:
    return ((time_us, number, content) for time_us, content in messages)


def _rows(frame: Any) -> Iterator[Message]:
    """Rows of a table by their moment, the first column of a time."""
    moment = next(name for name in frame.columns if name.endswith("_us"))
    for row in frame.sort(moment, maintain_order=True).iter_rows(named=True):
        told = {name: value for name, value in row.items() if value is not None}
        yield row[moment], {"timestamp": stamp(row[moment]), **told}


def events(plan: Any) -> Iterator[Message]:
    """What the scenario did to the network."""
    told = plan.scenario.model.event
    harm = networks()[plan.kind].harm
    done = [
        (fault.at_us, WARNING if told[fault.index].action in harm else INFORMATION,
         _sentence(plan, fault)) for fault in plan.faults
    ]  # fmt: skip
    own = [(at_us, INFORMATION, words) for at_us, words in own_events(plan)]
    for at_us, level, message in sorted([*done, *own], key=itemgetter(0)):
        yield at_us, {
            "timestamp": stamp(at_us), "level": level, "message": message,
            "name": "scenario", "file": "", "line": 0,
        }  # fmt: skip


def _sentence(plan: Any, fault: Any) -> str:
    """What was done to whom, drawn ones by their names, without its time."""
    said: str = networks()[plan.kind].fault_words(plan, fault).partition(" s ")[2]
    return said
