"""The pages' tables of mesh keys: all keys, no others, and the defaults they name."""

import re
from pathlib import Path

import msgspec
import pytest

from innervate.networks.mesh.protocol import fields as mesh_fields
from innervate.networks.mesh.scenario import model as mesh_model
from innervate.networks.mesh.scenario import settings as mesh_settings

PAGE = Path(__file__).resolve().parents[3] / "docs" / "scenarios.md"
TABLES = {
    "[placement]": mesh_model.PlacementTable,
    "[[node]]": mesh_model.NodeTable,
    "[[link]]": mesh_model.LinkedTable,
    "[import]": mesh_model.ImportTable,
    "[radio]": mesh_model.MeshRadioTable,
    "[protocol]": mesh_settings.MeshProtocolTable,
    "[fence]": mesh_model.FenceTable,
    "[[robot]]": mesh_model.RobotTable,
    "[[flow]]": mesh_model.FlowTable,
    "[[event]]": mesh_model.MeshEventTable,
}


def section():
    return PAGE.read_text(encoding="utf-8").split("\n## Meshes\n")[1]


def rows(name):
    lines = section().split(f"| `{name}` |")[1].split("\n\n")[0].splitlines()[2:]
    return [[cell.strip() for cell in re.split(r"(?<!\\)\|", line)[1:-1]] for line in lines]


@pytest.mark.parametrize("name", TABLES)
def test_every_key_is_documented(name):
    found = {key for row in rows(name) for key in re.findall(r"`(\w+)`", row[0])}
    assert found == {field.encode_name for field in msgspec.structs.fields(TABLES[name])}


def test_every_key_at_the_top_is_documented():
    for field in msgspec.structs.fields(mesh_model.MeshScenario):
        name = field.encode_name
        assert f"`{name}`" in section() or f"[{name}]" in section() or name == "kind"


@pytest.mark.parametrize("name", [n for n in TABLES if n not in ("[[event]]", "[[node]]")])
def test_defaults_that_are_named(name):
    """Where the page gives one number or one word, it is what the model takes."""
    fields = {field.encode_name: field.default for field in msgspec.structs.fields(TABLES[name])}
    for keys, _, left_out, _ in rows(name):
        for key in re.findall(r"`(\w+)`", keys):
            default = fields[key]
            if isinstance(default, bool):
                assert left_out == ("true" if default else "false"), key
            elif isinstance(default, int | float) and re.fullmatch(r"[\d.]+", left_out):
                assert float(left_out) == default, key
            elif isinstance(default, str):
                assert left_out == default, key


def test_the_size_of_a_nodes_state():
    """Declared widths in whole bits, without the queue: at 50 nodes less than 4 KiB."""
    state = mesh_fields.node(50)[: -len(mesh_fields.queued(mesh_fields.QUEUE))]
    bits = sum(max(length, 1) * (high - low).bit_length() for _, length, low, high, _, _ in state)
    page = (PAGE.parent / "mesh.md").read_text(encoding="utf-8")
    assert f"is {bits // 8:,} bytes at 50 nodes" in page
    assert bits < 8 * 4096
