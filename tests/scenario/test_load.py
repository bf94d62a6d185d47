"""Files, texts and dicts become scenarios, and scenarios become text again."""

from __future__ import annotations

import gc
import inspect
import tomllib
from pathlib import Path

import msgspec
import pytest

from innervate.scenario import (
    Scenario,
    ScenarioError,
    bundled,
    check,
    dump,
    from_dict,
    json_schema,
    load,
    loads,
    plan,
    template,
)
from innervate.scenario.lines import key_lines


def test_defaults(small: str) -> None:
    scenario = loads(small, path="some/skin-of-mine.toml")
    assert (scenario.kind, scenario.name, scenario.seed) == ("skin", "skin-of-mine", 1)
    assert scenario.duration_s == 4.0
    assert scenario.model.protocol.rule == "feasible"
    assert scenario.model.protocol.updates == "wave"
    assert scenario.model.timing.hop_latency_us == (80, 160)
    assert scenario.model.data.rate_hz == 0


def test_overrides_and_seed(small: str) -> None:
    sets = [
        "protocol.k=5",
        "protocol.rule=strict",
        'name="a b"',
        "event.0.at_s=1",
        "event.1.at_s=3",
        "event.1.action=restore",
        "event.1.interface=1",
        ("data.rate_hz", 50),
    ]
    scenario = loads(small, sets, seed=9)
    assert scenario.model.protocol.k == 5
    assert scenario.model.protocol.rule == "strict"
    assert scenario.name == "a b"
    assert [event.at_s for event in scenario.model.event] == [1.0, 3.0]
    assert scenario.model.data.rate_hz == 50
    assert scenario.seed == 9


def test_overrides_do_not_change_the_callers_dict() -> None:
    tables = {"kind": "skin", "patch": [{"columns": 2, "rows": 2}]}
    from_dict(tables, ["patch.0.rows=9", "protocol.k=4"])
    assert tables == {"kind": "skin", "patch": [{"columns": 2, "rows": 2}]}


def _links_robot(scenario: Scenario) -> bool:
    return scenario.model.body is not None


SKINS = [name for name in bundled() if not name.startswith(("radio", "mesh", "babel"))]


@pytest.mark.parametrize("name", sorted(bundled()))
def test_bundled_scenarios_have_a_name_and_a_first_line(name: str) -> None:
    assert load(name).name == name
    assert loads(dump(load(name))).model == load(name).model
    assert bundled()[name].read_text(encoding="utf-8").startswith("# ")


@pytest.mark.parametrize("name", sorted(SKINS))
def test_bundled_skins(name: str) -> None:
    scenario = load(name)
    assert scenario.name == name
    if _links_robot(scenario):
        pytest.importorskip("icub_models")
    made = plan(scenario)
    again = loads(dump(scenario))
    assert again.model == scenario.model
    assert plan(again).faults == made.faults
    summary = check(name)
    assert f"{made.graph.cells:,}" in summary
    extra = (made.touch is not None) + bool(made.script) + len(made.faults)
    told = [line for line in summary.splitlines() if not line.startswith("  warning ")]
    assert len(told) == 4 + extra
    first = bundled()[name].read_text(encoding="utf-8").splitlines()[0]
    assert first.startswith("# ")


def test_setups_are_all_there() -> None:
    names = {f"setup-{i}" for i in range(1, 9)}
    assert names | {"demo", "line", "joined", "loose", "icub-forearm", "icub-leg"} <= set(bundled())


def test_demo_does_not_saturate_one_cable() -> None:
    made = plan(load("demo"))
    frames_per_s = made.graph.cells * 1_000_000 // made.data_period_us
    assert frames_per_s < 1_000_000 * 0.98 / made.wire_us


def test_template_runs_as_it_is() -> None:
    made = plan(loads(template("skin")))
    assert made.graph.cells == 99
    assert len(made.faults) == 1


def test_dump_keeps_odd_strings() -> None:
    tables = {"kind": "skin", "name": 'a"\\é \u05d0', "link": [{"a": "x y", "b": "pc"}]}
    scenario = from_dict(tables)
    assert loads(dump(scenario)).model == scenario.model


def test_the_name_of_a_file_is_told_in_one_line(tmp_path: Path) -> None:
    file = tmp_path / "a\u202eb\n.toml"
    file.write_text('kind = "skin"\n[[link]]\na = "x"\nb = "pc"\n')
    assert load(file).name == "a\\u202eb\\n"


def test_relative_robot_files_stay_found(tmp_path: Path) -> None:
    text = 'kind = "skin"\n[body]\nurdf = "r.urdf"\nlinks = "s*"\n'
    (tmp_path / "x.toml").write_text(text)
    urdf = loads(dump(load(tmp_path / "x.toml"))).model.body
    assert urdf is not None
    assert urdf.urdf == str(tmp_path / "r.urdf")


def test_a_byte_order_mark_and_windows_lines(tmp_path: Path, small: str) -> None:
    file = tmp_path / "x.toml"
    file.write_bytes(b"\xef\xbb\xbf" + small.replace("\n", "\r\n").encode())
    assert load(file).model.protocol.k == 3


def test_json_schema_is_published() -> None:
    schema = json_schema()
    assert "SkinScenario" in schema["$defs"]
    said = [one["description"] for one in schema["$defs"].values() if "description" in one]
    assert any("\n" in words for words in said)
    assert said == [inspect.cleandoc(words) for words in said], "as deep as its class stands"
    told = msgspec.json.decode(msgspec.json.encode(schema))
    radio = told["$defs"]["RadioScenario"]
    assert radio["required"] == ["kind"]
    assert radio["properties"]["kind"] == {"enum": ["radio"]}
    assert radio["additionalProperties"] is False
    assert set(radio["properties"]) == {
        "kind", "schema", "name", "duration_s", "seed", "stations", "packet_slots", "traffic",
        "channel", "protocol", "event",
    }  # fmt: skip


def test_nothing_breaks_under_garbage_collection(small: str) -> None:
    first = loads(small).model
    for _ in range(2):
        again = loads(small).model
        gc.collect()
        assert again == first
    json_schema()
    gc.collect()


TEXT = '''\
# comment [x]
kind = "skin" # = [
"quoted key".'b' = """
multi = 1
""" # x
array = [ # one
  1,
  { a = 2, b.c = "}" },
  [3],
]
[a.b]
c.d = 'it''s'
[[list]]
x = 1
[[list]]
  x = 2
[list.sub]
y = 3
'''.replace("'it''s'", "'its'")


def test_lines_of_keys() -> None:
    tomllib.loads(TEXT)
    lines = key_lines(TEXT)
    assert lines[("kind",)] == 2
    assert lines[("quoted key", "b")] == 3
    assert lines[("array",)] == 6
    assert [lines[("array", i)] for i in range(3)] == [7, 8, 9]
    assert lines[("array", 1, "b", "c")] == 8
    assert lines[("a", "b", "c", "d")] == 12
    assert [lines[("list", i)] for i in range(2)] == [13, 15]
    assert lines[("list", 1, "x")] == 16
    assert lines[("list", 1, "sub", "y")] == 18


@pytest.mark.parametrize(("more", "words"), [(0, "not valid TOML"), (1, "over 64 MiB")])
def test_the_largest_file_that_is_read(tmp_path: Path, more: int, words: str) -> None:
    """Holes of a file read as zeros, which are no TOML."""
    path = tmp_path / "large.toml"
    with path.open("wb") as file:
        file.truncate(64 * 2**20 + more)
    with pytest.raises(ScenarioError, match=words):
        load(path)
