"""Summaries are what their types say: exactly those keys, each of the type declared."""

import ast
import json
from pathlib import Path

import msgspec
import pytest

import innervate
from innervate.analysis import summary_common
from innervate.networks.mesh.analysis import summary_keys as mesh_summary
from innervate.networks.radio.analysis import summary_keys as radio_summary
from innervate.networks.skin.analysis import summary_keys as skin_summary
from innervate.networks.typed import MeshSummary, RadioSummary, SkinSummary, SlottedSummary

RADIO = {"kind": "radio", "stations": 4, "duration_s": 5}
RUNS = {
    "a skin with a cut": (SkinSummary, "four", {}),
    "a skin without data or events": (SkinSummary, "four", {"data": {"rate_hz": 0}, "event": []}),
    "a disaster": (RadioSummary, RADIO, {}),
    "delays outside the bounds": (
        RadioSummary, RADIO,
        {"channel": {"tau_us": [150, 200]}, "protocol": {"tau_bounds_us": [52, 104]}},
    ),
    "a channel on which nothing came": (RadioSummary, RADIO, {"duration_s": 0.101}),
    "saturated": (RadioSummary, RADIO, {"traffic": {"kind": "saturated"}}),
    "slots": (
        SlottedSummary, RADIO,
        {"channel": {"level": "slotted"}, "protocol": {"mac": "csma-cd-d2"}},
    ),
    "a field with deaths and an alarm": (MeshSummary, "mesh-field", {}),
    "a mesh without time for anything": (
        MeshSummary, {"kind": "mesh", "nodes": 4, "duration_s": 0.01}, {},
    ),
}  # fmt: skip


@pytest.fixture(scope="module")
def done():
    """Runs by what they show, each simulated once."""
    kept = {}

    def of(name, four):
        if name not in kept:
            _, given, changes = RUNS[name]
            tables = four() if given == "four" else given
            kept[name] = innervate.run(tables if isinstance(tables, str) else tables | changes)
        return kept[name]

    return of


@pytest.mark.parametrize("name", RUNS)
def test_a_summary_has_exactly_the_declared_keys_and_types(name, done, four):
    declared = RUNS[name][0]
    summary = done(name, four).summary
    # What is not declared falls away in the conversion, what is missing or another type fails.
    assert msgspec.convert(summary, declared) == summary
    assert msgspec.json.decode(json.dumps(summary), type=declared) == summary


def test_a_summary_of_another_shape_is_noticed(done, four):
    summary = done("a skin with a cut", four).summary
    more = summary | {"recoveries": [summary["recoveries"][0] | {"undeclared_ms": 1.0}]}
    assert msgspec.convert(more, SkinSummary) != more
    for wrong in ({"cells": "4"}, {"kind": "mesh"}, {"loops": {"episodes": 1}}):
        with pytest.raises(msgspec.ValidationError):
            msgspec.convert(summary | wrong, SkinSummary)


def test_runs_that_were_ended_early_say_when(done, four):
    summary = done("a skin with a cut", four).summary | {"interrupted_at_s": 0.25}
    assert msgspec.convert(summary, SkinSummary) == summary
    with pytest.raises(msgspec.ValidationError):
        msgspec.convert(summary | {"interrupted_at_s": "soon"}, SkinSummary)


@pytest.mark.parametrize(
    "room", [mesh_summary, radio_summary, skin_summary, summary_common], ids=lambda m: m.__name__
)
def test_every_key_is_explained(room):
    for made in ast.parse(Path(room.__file__).read_text()).body:
        if isinstance(made, ast.ClassDef):
            fields = [node.target.id for node in made.body if isinstance(node, ast.AnnAssign)]
            listed = ast.get_docstring(made).partition("Attributes:")[2]
            told = [key for key in fields if f"\n    {key}: " in listed]
            # Few that belong together may have one sentence for all.
            assert set(fields) - {"kind", "level"} == set(told) or not listed, made.name
            assert listed or len(fields) < 8, made.name


@pytest.mark.parametrize("name", RUNS)
def test_the_typed_view_is_the_summary_and_there_is_one(name, done, four):
    run = done(name, four)
    views = {"SkinSummary": "skin", "RadioSummary": "radio", "SlottedSummary": "slotted",
             "MeshSummary": "mesh"}  # fmt: skip
    mine = views.pop(RUNS[name][0].__name__)
    assert getattr(run, mine) is run.summary
    for other in views.values():
        with pytest.raises(AttributeError, match=rf"no summary '{other}'; run\.{mine} is"):
            getattr(run, other)


@pytest.mark.parametrize("name", RUNS)
def test_a_run_shows_itself_in_a_notebook(name, done, four):
    shown = done(name, four)._repr_html_()
    assert shown.startswith('<div class="innervate-run"><style>.innervate-run{')
    assert "<h1>" in shown
    assert ":root" not in shown  # or it would colour the notebook
    if name not in ("a channel on which nothing came",):
        assert "<svg" in shown
    assert not any(word in shown for word in ("<script", "<link", "http-equiv", "src="))
