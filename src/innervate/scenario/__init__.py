"""Scenario files: TOML to a validated model, and on to the plan of a run."""

import inspect
from pathlib import Path
from typing import Any

from innervate.network import find, first, networks
from innervate.scenario.bundled import bundled
from innervate.scenario.emit import dump, inline
from innervate.scenario.errors import ScenarioError
from innervate.scenario.explain import nearest
from innervate.scenario.given import check, summary
from innervate.scenario.load import Scenario, from_dict, load, loads, read

__all__ = [
    "Scenario",
    "ScenarioError",
    "bundled",
    "check",
    "dump",
    "from_dict",
    "inline",
    "json_schema",
    "load",
    "loads",
    "plan",
    "read",
    "summary",
    "template",
]


def plan(scenario: Scenario) -> Any:
    """The plan of a run, whole numbers only: same scenario and seed, same plan.

    Raises:
        ScenarioError: it cannot be run as written.
    """
    return networks()[scenario.kind].plan(scenario)


def template(kind: str | None = None) -> str:
    """A commented scenario of a kind, ready to run; of the first kind if none is named.

    Raises:
        ScenarioError: there is no such kind.
        NetworkError: a folder of that name, in the present one, cannot be loaded.
    """
    kind = first() if kind is None else kind
    network = find(kind, Path())
    if network is not None:
        return str(network.template) or _all_keys(network.name)
    hint = nearest(kind, list(networks())).replace("it knows", "there is")
    own = (
        "" if hint.startswith("; did") else "; to make one of your own: innervate new network NAME"
    )
    raise ScenarioError(f'there is no kind "{kind[:40]}"{hint}{own}')


def _all_keys(kind: str) -> str:
    """A scenario of a kind that has no template: every key, as it is if left out."""
    return f"# A {kind}: every key as it is if left out.\n{dump(from_dict({'kind': kind}))}"


def json_schema() -> dict[str, Any]:
    """The JSON Schema of scenario files, for editors."""
    import msgspec

    schemas, parts = msgspec.json.schema_components(
        dict.fromkeys(network.model for network in networks().values())
    )
    for part in parts.values():  # msgspec before 0.23 leaves docstrings indented
        if "description" in part:
            part["description"] = inspect.cleandoc(part["description"])
    for network in networks().values():
        table = parts[network.model.__name__]  # code says the kind by its class, a file by the key
        table["properties"]["kind"].pop("default", None)
        table["required"] = list(dict.fromkeys(["kind", *table.get("required", ())]))
    return {"anyOf": list(schemas), "$defs": parts}
