"""A scenario however it is given: a file, a bundled name, tables, or one that is loaded."""

import os
from collections.abc import Iterable, Mapping
from typing import Any

from msgspec import Struct, structs

from innervate.network import networks
from innervate.scenario.emit import dump as as_text
from innervate.scenario.errors import ScenarioError
from innervate.scenario.load import Scenario, from_dict, loads
from innervate.scenario.load import load as load_file
from innervate.scenario.source import OPTION

Given = str | os.PathLike[str] | Scenario | Struct | dict[str, Any]
Changes = Iterable[str] | Mapping[str, Any]
OVERRIDE = "override"  # what errors call one that is given from Python


def load(scenario: Given, *, seed: int | None = None, overrides: Changes = ()) -> Scenario:
    """The scenario meant by a file, a bundled name, tables or a Scenario, validated.

    Args:
        scenario: a file, a bundled name ("setup-1"), tables as in a file, a model of them built in
            code (Skin, Radio, Mesh, CablesScenario, ...), or a Scenario.
        seed: in place of the scenario's, 0 .. 2^63-1.
        overrides: "a.b=c" texts, one or several, or a mapping from dotted keys to values.

    Raises:
        ScenarioError: it is not valid; one line that says what to change.
    """
    if isinstance(overrides, str):
        overrides = [overrides]  # and not its letters
    changes: list[str | tuple[str, Any]] = (
        list(overrides.items()) if isinstance(overrides, Mapping) else list(overrides)
    )
    try:
        made = _load(scenario, changes, seed)
    except ScenarioError as error:
        option, _, text = error.path.partition(" ")
        if option != OPTION:
            raise
        path = f"{OVERRIDE} {text}"
        raise ScenarioError(error.message, path, error.line, error.key) from None
    made.source.override = OVERRIDE
    return made


def _load(scenario: Given, changes: list[str | tuple[str, Any]], seed: int | None) -> Scenario:
    if isinstance(scenario, Struct):
        return from_dict(tables_of(scenario), changes, seed)
    if isinstance(scenario, dict):
        return from_dict(scenario, changes, seed)
    if not isinstance(scenario, Scenario):
        return load_file(scenario, changes, seed)
    if seed is None and not changes:
        return scenario
    text, source = as_text(scenario, whole=False), scenario.source
    return loads(text, changes, seed, source.path, source.folder)


def dump(scenario: Given) -> str:
    """A scenario as the text of a file, with what was given and without what was left out.

    Args:
        scenario: as for load().

    Raises:
        ScenarioError: it is not valid.
    """
    return as_text(load(scenario), whole=False)


def tables_of(model: Struct) -> dict[str, Any]:
    """The tables of a model built in code, as a file has them: what was left out is not there."""
    tables: dict[str, Any] = _plain(model)
    return {"kind": getattr(model, "kind", None), **tables}


def _plain(value: Any) -> Any:
    if isinstance(value, Struct):
        return {field.encode_name: _plain(given) for field in structs.fields(value)
                if (given := getattr(value, field.name)) is not field.default
                and not (given == [] and field.default_factory is list)}  # fmt: skip
    if isinstance(value, list | tuple):
        return [_plain(inner) for inner in value]
    return value


def check(scenario: Given, *, seed: int | None = None, overrides: Changes = ()) -> str:
    """What a scenario holds, in the lines that `innervate check` prints; nothing is run.

    Args:
        scenario: as for load().
        seed: in place of the scenario's.
        overrides: "a.b=c" texts, or a mapping from dotted keys to values.

    Raises:
        ScenarioError: it cannot be run as written.
    """
    return summary(load(scenario, seed=seed, overrides=overrides))


def summary(loaded: Scenario) -> str:
    """What a scenario holds, several lines, without a newline at the end.

    Raises:
        ScenarioError: it cannot be run as written.
    """
    network = networks()[loaded.kind]
    return str(network.describe(network.plan(loaded)))
