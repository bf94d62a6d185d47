"""Hostile values in every field of what nodes read: one line that names the file and the field.

The fields are those of the declared tables, and so are the tables' kinds: what is added to one of
them is tried here without another word.
"""

import asyncio
import copy
import json
import re
import tomllib
import typing

import msgspec
import pytest

from innervate import scenario
from innervate.live import identity as identities
from innervate.live.enrolment import Authority
from innervate.live.errors import LiveError
from innervate.live.main import Process
from innervate.live.nodefile import load
from innervate.network import networks

LONG = "9" * 5_000
TEXTS = [
    "", " ", "\0", "a\0b", "\x7f", "a\nb", "\x1b[2J", "x" * 300, "x" * 5_000, "\u00e9\u202e",
    "\0:4700", "127.0.0.1\0:4700", f"{'x' * 300}:4700", "..:4700", "[::1]:4700", "-\u00e9:4700",
    "127.0.0.1:-1", f"127.0.0.1:{LONG}", "127.0.0.1:\uff14700", "256.0.0.1:80", ":80", "/", "..",
    "file:", "file:\0", f"file:{'x' * 300}", f"file:{'x' * 5_000}", "file:/", LONG,
]  # fmt: skip
NUMBERS = ["-1", "0", "1", "255", "65536", "9223372036854775808", "-9223372036854775809",
           "1" + 400 * "0", LONG, f"-{LONG}", f"0x{'f' * 5_000}", "nan", "-inf", "1e999",
           "1e-999", "0.5", "true"]  # fmt: skip
VALUES = [*map(json.dumps, TEXTS), *NUMBERS, "[]", "{}", "[[1]]", f"[{LONG}]",
          f"{'[' * 5_000}{']' * 5_000}", f"{{a{'.a' * 5_000} = 1}}", "2026-01-01",
          '["\\u0000"]']  # fmt: skip
# What stands in a node's file where nothing is tried; the socket of no process is there.
UDP = {"kind": "udp", "bind": "127.0.0.1:0", "peers": ["127.0.0.1:9"]}
GROUP = {"kind": "multicast", "group": "239.77.12.5:47012", "interface": "127.0.0.1"}
SERIAL = {"kind": "serial", "device": "none", "far": "none", "baud": 115_200}
KEYS = {"use": 1, "secret": {"1": "ab" * 32}, "ends": True, "grace_s": 1.0}
# What any node's file can have, and what is particular to a kind: values that a node starts with.
ALL = {"number": 1, "name": "n", "nodes": 3, "socket": "n.sock", "state": "n.state",
       "engine": "python", "awake": False, "warm": False, "metrics": "127.0.0.1:0"}  # fmt: skip
FILES = {
    "mesh": {"role": "standby", "rank": 2, "robot": True, "keys": KEYS,
             "deliver": {"in_order": True, "wait_ms": 100, "buffer": 8},
             "fence": {"polygon": [[0, 0], [90, 0], [90, 90]],
                       "holes": [[[40, 9], [50, 9], [50, 20]]]},
             "link": [UDP, GROUP, SERIAL]},
    "skin": {"role": "cell", "ports": [0, 2], "rate_hz": 50.0, "keys": {"identity": "n.identity"},
             "link": [UDP, SERIAL]},
    "radio": {"role": "station", "link": [{"kind": "medium", "address": "127.0.0.1:9"}]},
    "flooding": {"role": "node", "ports": [0], "link": [UDP]},
}  # fmt: skip


def base(kind):
    """A file with all that nodes of a kind know."""
    return {"kind": kind, **ALL, "protocol": protocol_of(kind), **FILES[kind]}


def protocol_of(kind):
    if kind in ("mesh", "skin", "radio"):
        return {}
    tables = {"kind": kind, "nodes": 3}
    return {name: value for name, value in scenario.plan(scenario.from_dict(tables)).params.items()
            if isinstance(value, int)}  # fmt: skip


def fields(table):
    """The names of all fields of a table and of those in it."""
    found = set()
    for one in msgspec.structs.fields(table):
        found.add(one.encode_name)
        found |= set().union(*map(fields, structs_in(one.type)), set())
    return found


def structs_in(kind):
    """The tables that a type can be, lists and choices looked into."""
    if isinstance(kind, type) and issubclass(kind, msgspec.Struct):
        return [kind]
    return [found for part in typing.get_args(kind) for found in structs_in(part)]


def places(value, way=()):
    """The ways to all that stands in tables, tables and lists themselves among them."""
    if way:
        yield way
    inner = (
        value.items()
        if isinstance(value, dict)
        else enumerate(value)
        if isinstance(value, list)
        else ()
    )
    for part, found in inner:
        yield from places(found, (*way, part))


class Raw(str):
    """A value as it stands in a file."""


def toml(value):
    if isinstance(value, dict):
        return "{" + ", ".join(f"{toml(key)} = {toml(one)}" for key, one in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ",\n".join(map(toml, value)) + "]"
    return str(value) if isinstance(value, Raw) else json.dumps(value)


def text_of(tables):
    return "".join(f"{toml(key)} = {toml(value)}\n" for key, value in tables.items())


def changed(tables, way, value):
    """Tables with another value at one place."""
    found = copy.deepcopy(tables)
    inner = found
    for part in way[:-1]:
        inner = inner[part]
    inner[way[-1]] = value
    return found


async def tried(path):
    """Make a node of a file, start it and stop it."""
    process = Process(load(path))
    process.ending.set()
    await process.run()


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    Authority(tmp_path / "keys").enrol(1).rename(tmp_path / "n.identity")
    return tmp_path


def complaint(path, name, what=tried):
    """What is said of a file; "" = nothing. It is one line, with the file and the field.

    Of what cannot be read the line stands in the place of the field.
    """
    try:
        asyncio.run(what(path))
    except LiveError as error:
        said = str(error)
        assert said.isprintable()
        assert len(said) < 2_000
        assert str(path) in said
        told = said.replace(str(path), "")
        assert name in told or re.search(r": line [0-9]+\b.*(too long|nested)", told)
        return said
    return ""


WAYS = [(kind, way) for kind in FILES for way in places(base(kind))]


@pytest.mark.parametrize("kind", FILES)
def test_all_fields_are_tried(kind, folder):
    file = networks()[kind].node_file
    assert set(file.__struct_fields__) - {"keys"} <= base(kind).keys()
    assert fields(file) <= {part for _, way in WAYS for part in way}
    (folder / "n0.toml").write_text(text_of(base(kind)))
    assert complaint(folder / "n0.toml", "") == ""


def name_in(way):
    return next(part for part in reversed(way) if isinstance(part, str))


@pytest.mark.parametrize(
    ("kind", "way"),
    WAYS,
    ids=lambda one: ".".join(map(str, one)) if isinstance(one, tuple) else one,
)
def test_whatever_stands_in_a_field_is_taken_or_refused_in_a_line(kind, way, folder):
    tables, path, bad = base(kind), folder / "n0.toml", []
    for value in VALUES:
        path.write_text(text_of(changed(tables, way, Raw(value))))
        try:
            complaint(path, name_in(way))
        except BaseException as error:
            bad.append(f"{value[:30]}: {error!r}"[:400])
    assert bad == []


async def identity_of(path):
    """Read an identity as its node does."""
    identities.load(path, 1)


async def authority_of(path):
    """Take over an authority's folder, enrol a node more and put one out."""
    made = Authority(path.parent)
    made.enrol(1 + max((number for number, _ in made.issued), default=0))
    made.revoke([number for number, _ in made.issued][:1])


@pytest.mark.parametrize(("file", "what"), [
    ("n1.identity", identity_of), ("authority.key", authority_of),
], ids=["identity", "authority"])  # fmt: skip
def test_so_are_fields_of_keys(file, what, tmp_path):
    authority = Authority(tmp_path / "keys")
    for number in (1, 2):
        authority.enrol(number)
    authority.revoke([2])
    path, bad = tmp_path / "keys" / file, []
    good = tomllib.loads(path.read_text())
    path.write_text(text_of(good))
    assert complaint(path, "", what) == ""
    for way in places(good):
        for value in VALUES:
            path.write_text(text_of(changed(good, way, Raw(value))))
            try:
                complaint(path, name_in(way), what)
            except BaseException as error:
                bad.append(f"{way} {value[:30]}: {error!r}"[:400])
        left = {key: one for key, one in good.items() if key != way[0]}
        path.write_text(text_of(left))
        assert way[0] in complaint(path, way[0], what)
    assert bad == []


def test_an_identity_whose_parts_are_not_of_one_is_refused(tmp_path):
    authority = Authority(tmp_path)
    one, other = (tomllib.loads(authority.enrol(number).read_text()) for number in (1, 2))
    for name in identities.SIZES.keys() - {"shared"}:
        (tmp_path / "x").write_text(text_of(one | {name: other[name]}))
        if one[name] != other[name]:
            assert complaint(tmp_path / "x", "signature", identity_of)
