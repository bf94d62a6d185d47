"""Whatever is thrown at the loader, only a ScenarioError of one line comes out."""

from __future__ import annotations

import string
from collections.abc import Callable
from typing import Any

from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from innervate.networks.skin.scenario.plan import Plan
from innervate.scenario import Scenario, ScenarioError, bundled, from_dict, loads, plan

FEW = settings(
    max_examples=150, deadline=None, suppress_health_check=[HealthCheck.too_slow]
)  # the full count runs in `make full`

KEYS = (
    "kind", "schema", "name", "duration_s", "seed", "patch", "interface", "cable", "link", "body",
    "protocol", "timing", "data", "touch", "event", "script", "columns", "rows", "wiring",
    "count", "interfaces_every", "row", "column", "port", "a", "b", "urdf", "links", "reach_mm",
    "interfaces", "rule", "k", "r_f", "r_r", "m", "at_s", "action", "cell", "node", "pc",
    "random", "loss", "frames", "steps", "path",
)  # fmt: skip
WORDS = ("skin", "Z", "S", "cut", "kill", "revive", "restore", "lose", "loose", "restart", "pc",
         "n1", "n1.2", "pc.0", "p0r0c0", "E", "link", "cell", "tick pc", "static")  # fmt: skip

scalars = st.one_of(
    st.booleans(),
    st.integers(-3, 12),
    st.integers(),
    st.floats(),
    st.sampled_from(WORDS),
    st.text(max_size=12),
    st.dates(),
    st.datetimes(),
)
values = st.recursive(
    scalars,
    lambda inner: st.one_of(
        st.lists(inner, max_size=3),
        st.dictionaries(st.one_of(st.sampled_from(KEYS), st.text(max_size=5)), inner, max_size=4),
    ),
    max_leaves=12,
)


def survives(make: Callable[[], Scenario]) -> Plan | None:
    """Load and plan; anything but a ScenarioError of one printable line fails the test."""
    try:
        scenario = make()
        if scenario.kind != "skin":
            return plan(scenario) if scenario.duration_s < 1000 else None
        cells = sum(patch.columns * patch.rows * patch.count for patch in scenario.model.patch)
        return plan(scenario) if cells < 20_000 else None
    except ScenarioError as error:
        line = str(error)
    assert line
    assert line.isprintable()
    return None


@FEW
@given(st.text())
def test_any_text(text: str) -> None:
    survives(lambda: loads(text, path="x.toml"))


@FEW
@given(st.lists(st.tuples(st.sampled_from(KEYS), st.text(string.printable, max_size=20))))
def test_any_lines(pairs: list[tuple[str, str]]) -> None:
    text = "".join(f"{key} = {value}\n" for key, value in pairs)
    survives(lambda: loads('kind = "skin"\n' + text, path="x.toml"))


@FEW
@given(st.dictionaries(st.one_of(st.sampled_from(KEYS), st.text(max_size=5)), values, max_size=8))
def test_any_dict(tables: dict[str, Any]) -> None:
    survives(lambda: from_dict(tables))
    survives(lambda: from_dict({**tables, "kind": "skin"}))


@FEW
@given(st.data())
def test_changed_scenarios(data: st.DataObject) -> None:
    name = data.draw(st.sampled_from([n for n in bundled() if not n.startswith("icub")]))
    text = bundled()[name].read_text(encoding="utf-8")
    lines = text.splitlines()
    for _ in range(data.draw(st.integers(1, 3))):
        index = data.draw(st.integers(0, len(lines) - 1))
        kind = data.draw(st.sampled_from(("drop", "double", "value", "cut short", "other")))
        key, equals, _ = lines[index].partition("=")
        if kind == "drop":
            lines[index] = ""
        elif kind == "double":
            lines.insert(index, lines[index])
        elif kind == "value" and equals:
            word = data.draw(st.one_of(st.integers(-2, 300), st.floats(), st.sampled_from(WORDS)))
            lines[index] = f"{key}= {word!r}"
        elif kind == "cut short":
            lines[index] = lines[index][: data.draw(st.integers(0, 20))]
        else:
            lines[index] = data.draw(st.text(max_size=20))
    survives(lambda: loads("\n".join(lines), path="x.toml"))


@FEW
@given(
    st.lists(
        st.tuples(st.lists(st.sampled_from((*KEYS, "0", "1", "")), min_size=1, max_size=4), values),
        max_size=3,
    )
)
def test_any_override(pairs: list[tuple[list[str], Any]]) -> None:
    text = bundled()["setup-3"].read_text(encoding="utf-8")
    survives(lambda: loads(text, [(".".join(parts), value) for parts, value in pairs]))
    survives(lambda: loads(text, [f"{'.'.join(parts)}={value}" for parts, value in pairs]))


def test_deep_and_long_things() -> None:
    for text in (
        "a = " + "[" * 5000,
        "a = " + "[" * 300 + "]" * 300,
        "a = " + "9" * 6000,
        "a" + ".a" * 3000 + " = 1",
        "[" + "a." * 3000 + "a]",
    ):
        whole = 'kind = "skin"\n' + text
        assert survives(lambda whole=whole: loads(whole)) is None  # type: ignore[misc]
    ring: dict[str, Any] = {"kind": "skin"}
    ring["patch"] = ring
    assert survives(lambda: from_dict(ring)) is None
    assert survives(lambda: from_dict({1: 2, "kind": "skin"})) is None  # type: ignore[dict-item]
    assert survives(lambda: from_dict([])) is None  # type: ignore[arg-type]
