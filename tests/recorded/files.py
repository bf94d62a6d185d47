"""What small runs leave as files: captures, recordings, graphs, tables; and what is fitted of them.

The runs are those of other tests, so that no loop is compiled for them alone.
"""

from __future__ import annotations

import json
import tempfile
from collections import Counter
from collections.abc import Callable, Iterator
from functools import cache, partial
from pathlib import Path
from typing import Any

import polars
from mcap.reader import make_reader

import innervate
from innervate import scenario as scenarios
from innervate.export import capture, dissector, fitting, graphs, measure, recording, rrd, schemas
from innervate.export import tables as tables_files
from innervate.export.reading import Capture
from innervate.network import networks
from innervate.networks.skin.export import recovery
from tests.export.test_captures import MESH, RADIO
from tests.export.test_captures import SKIN as CAPTURED
from tests.export.test_files import FENCED, TOUCHED
from tests.export.test_fit import RING
from tests.export.test_fit import SKIN as LOOSE
from tests.networks.skin.runs import patch
from tests.recorded.data import digest, plain
from tests.recorded.declared import OURS
from tests.recorded.plans import SMALL

HEALING = patch(
    4, 4, (0, 1), (3, 2),
    duration_s=1.6, seed=8, data={"rate_hz": 100}, protocol={"beacon_hz": 50, "k": 3},
    event=[{"at_s": 0.5, "action": "cut", "interface": 1},
           {"at_s": 0.8, "action": "kill", "cell": {"row": 1, "column": 1}},
           {"at_s": 1.0, "action": "restore", "interface": 1},
           {"at_s": 1.2, "action": "revive", "cell": {"row": 1, "column": 1}}],
)  # fmt: skip
CAPTURES = {"skin": CAPTURED, "mesh": MESH, "radio": RADIO, "ring": RING, "loose": LOOSE,
            "healing": HEALING}  # fmt: skip
RUNS = {"skin": TOUCHED, "mesh": FENCED, "radio": RADIO}
OF_THE_CLOCK = "RecordingInfo:start_time"
SHOWN = 40  # packets of a capture that are kept one by one
OF_SCHEMAS = ("SCENE", "CELLS", "TOUCH", "ROBOT", "LOG")
STATUS = [
    {"kind": "mesh", "number": 0, "gateway": 2, "neighbours": [
        {"node": 1, "quality": 0.49}, {"node": 2, "quality": 1.5}, {"node": 3, "quality": None}]},
    {"kind": "mesh", "number": 1, "gateway": None, "neighbours": [{"node": 0, "quality": 0.64}]},
    {"kind": "mesh", "number": 2, "gateway": 2, "neighbours": [{"node": 0, "quality": -0.5}]},
]  # fmt: skip


def found() -> Iterator[tuple[str, Callable[[], Any]]]:
    """Name and content of everything."""
    yield "dissector", lambda: dissector.source().splitlines()
    yield "schemas", lambda: {name: plain(getattr(schemas, name)) for name in OF_SCHEMAS}
    for kind in OURS:
        yield f"schemas of {kind} tables", partial(_table_schemas, kind)
    for name in CAPTURES:
        yield f"capture of {name}", partial(_capture, name)
    for name in ("ring", "loose", "skin", "mesh"):
        yield f"fitted of {name}", partial(_fitted, name)
    yield "fitted of what nodes said", _said
    for name in ("healing", "loose", "skin"):
        yield f"healing in {name}", partial(_healing, name)
    for name in RUNS:
        yield f"graph of {name}", partial(_graph, name)
        yield f"tables of {name}", partial(_tables, name)
        yield f"recording of {name}", partial(_recording, name)
    for name in ("mesh-fence", "mesh-links", "skin-copies", "skin-links", "radio-all"):
        yield f"graph of {name}", partial(_graph, name)
    for name in ("skin", "mesh"):
        yield f"recording of {name} for Rerun", partial(_rerun, name)


@cache
def _folder() -> tempfile.TemporaryDirectory[str]:
    return tempfile.TemporaryDirectory(prefix="innervate-files-")


def _path(name: str) -> Path:
    return Path(_folder().name) / name


def plan_of(name: str) -> Any:
    """The plan of one of the runs, or of a small scenario."""
    if name in CAPTURES | RUNS:
        return scenarios.plan(scenarios.from_dict(RUNS.get(name) or CAPTURES[name]))
    return scenarios.plan(scenarios.load(SMALL / f"{name}.toml"))


@cache
def captured(name: str) -> tuple[Path, Any]:
    """A capture's file, and what was written."""
    path = _path(f"{name}.pcapng")
    return path, capture.write(scenarios.plan(scenarios.from_dict(CAPTURES[name])), path)


@cache
def ran(name: str) -> tuple[Any, dict[str, Any]]:
    """A run's plan and its tables."""
    done = innervate.run(RUNS[name])
    return done.plan, {name: table.collect() for name, table in done.tables.items()}


def _table_schemas(kind: str) -> Any:
    return {table.name: plain(schemas.of_table(table)) for table in networks()[kind].tables}


def _capture(name: str) -> Any:
    path, written = captured(name)
    read = Capture(path)
    packets = [(one.interface, one.time_ns, one.data.hex(), one.flags, one.comment)
               for one in read.packets()]  # fmt: skip
    said = Counter(f"{flags} {comment}".strip() for *_, flags, comment in packets)
    return {
        "says": read.comment,
        "interfaces": plain(read.interfaces),
        "written": plain([written.frames, written.sent, written.received, written.dropped]),
        "by flags and comment": dict(sorted(said.items())),
        "first": [list(one) for one in packets[:SHOWN]],
        "all": digest([list(one) for one in packets]),
    }


def _fitted(name: str) -> Any:
    path, _ = captured(name)
    got = measure.measure(path)
    ways = {f"{a} {b}": plain([way.got, way.lost, list(way.delays_us), list(way.sizes)])
            for (a, b), way in got.ways.items()}  # fmt: skip
    told = {key: plain(value) for key, value in vars(got).items() if key != "ways"}
    text = fitting.scenario_of(got, name)
    return told | {
        "delay us": plain(got.delay_us()), "ways": ways, "scenario": text.splitlines(),
        "again": fitting.check(text, got) if name in ("ring", "loose") else None,
    }  # fmt: skip


def _said() -> Any:
    """A network out of what its nodes said of themselves."""
    path = _path("status.json")
    path.write_text(json.dumps(STATUS))
    got = measure.measure(path)
    ways = {f"{a} {b}": [way.got, way.lost] for (a, b), way in got.ways.items()}
    return {"gateway": got.gateway, "notes": got.notes, "ways": ways,
            "scenario": fitting.scenario_of(got, "said").splitlines()}  # fmt: skip


def _healing(name: str) -> Any:
    healed = recovery.recoveries(Capture(captured(name)[0]))
    return plain([{**plain(one), "line": recovery.line(one)} for one in healed])


def _graph(name: str) -> Any:
    plan, made = plan_of(name), {}
    for suffix in graphs.SUFFIXES:
        path = _path(f"graph-{name}{suffix}")
        graphs.write(plan, path)
        lines = path.read_text(encoding="utf-8").splitlines()
        made[suffix] = {"lines": len(lines), "all": digest(lines), "some": lines[:60:3]}
    return made | {"graph": plain(networks()[plan.kind].graph(plan))}


def _tables(name: str) -> Any:
    _, frames = ran(name)
    made: dict[str, Any] = {}
    lazy = {key: frame.lazy() for key, frame in frames.items()}
    for path in tables_files.write(lazy, _path(f"tables-{name}")):
        frame = polars.read_parquet(path)
        rows = [list(row) for row in frame.iter_rows()]
        made[path.name] = {
            "columns": {key: str(kind) for key, kind in frame.schema.items()},
            "rows": plain(rows),
        }
    for path in tables_files.write(lazy, _path(f"csv-{name}"), csv=True):
        lines = path.read_text(encoding="utf-8").splitlines()
        made[path.name] = {"lines": len(lines), "some": lines[:3], "all": digest(lines)}
    return made


def _recording(name: str) -> Any:
    plan, frames = ran(name)
    path = _path(f"{name}.mcap")
    count = recording.write(plan, frames, path)
    topics: dict[str, Any] = {}
    names: dict[str, str] = {}
    with path.open("rb") as file:
        reader = make_reader(file)
        for schema, channel, message in reader.iter_messages():
            one = [message.log_time, message.publish_time, json.loads(message.data)]
            topics.setdefault(channel.topic, []).append(one)
            names[channel.topic] = f"{schema.name}, {schema.encoding}, {channel.message_encoding}"
        about = {one.name: one.metadata for one in reader.iter_metadata()}
    kept = {topic: {"schema": names[topic], "messages": plain(of)} for topic, of in topics.items()}
    return {"count": count, "about": about, "topics": kept}


def _rerun(name: str) -> Any:
    """Entities and components of a recording for Rerun: rows, and what they hold."""
    import rerun.chunk as chunk

    plan, frames = ran(name)
    path = _path(f"{name}.rrd")
    count = rrd.write(plan, frames, path)
    rows: dict[str, list[Any]] = {}
    for part in chunk.RrdReader(path).stream():
        for row in part.to_record_batch().to_pylist():
            at = row.get(rrd.TIMELINE)
            moment = None if at is None else round(at.total_seconds() * 1e6)
            for key, value in row.items():
                if value is not None and ":" in key and not key.endswith(OF_THE_CLOCK):
                    rows.setdefault(f"{part.entity_path} {key}", []).append([moment, value])
    rounded = {key: [[at, _rounded(value)] for at, value in of] for key, of in rows.items()}
    return {"rows": count, **{key: plain(rounded[key]) for key in sorted(rounded)}}


def _rounded(value: Any) -> Any:
    """Single precision, as the viewer has it."""
    if isinstance(value, float):
        return float(f"{value:.5g}")
    if isinstance(value, list):
        return [_rounded(inner) for inner in value]
    return value
