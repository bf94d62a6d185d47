"""What is declared, and follows from declarations: keys with ranges and defaults, records, tables.

Also what a plan becomes when it is brought up live: node files and events.
"""

from __future__ import annotations

import dataclasses
import inspect
from collections.abc import Callable, Iterator
from functools import partial
from inspect import Parameter
from typing import Any

import msgspec

from innervate import scenario as scenarios
from innervate.cli.app import app
from innervate.live import play
from innervate.network import Network, networks
from innervate.networks.mesh.live.parameters import fence_parameters, mesh_parameters
from innervate.networks.mesh.verify.model import MeshBudget
from innervate.networks.radio.live.parameters import radio_parameters
from innervate.networks.radio.slotted.drive import Setting
from innervate.networks.radio.verify.grid import Grid
from innervate.networks.skin.live.parameters import skin_parameters
from innervate.networks.skin.sizing import Question
from innervate.networks.skin.verify.system import Budget as SkinBudget
from innervate.papers.jobs import entries, jobs
from innervate.running import simulating
from innervate.scenario.declared.cables import CablesScenario
from innervate.scenario.declared.channel import ChannelScenario
from innervate.scenario.declared.field import FieldScenario
from innervate.sweeping.planfile import PlanFile
from innervate.verify.states import Budget
from tests.recorded import plans
from tests.recorded.data import plain

UP = ("mesh-grid", "mesh-near", "mesh-fence", "mesh-links", "radio-few", "radio-all",
      "skin-patches", "skin-copies", "skin-links")  # fmt: skip
OURS = ("skin", "radio", "mesh")
DECLARED = {"cables": CablesScenario, "channel": ChannelScenario, "field": FieldScenario}
# What a user or a proof leaves out is as these have it.
ASKED = (MeshBudget, SkinBudget, Budget, Grid, Question, Setting)
FENCE = [[(0, 0), (900, 0), (23_000, 800), (0, 800)], [(50, 50), (60, 50), (60, 60)]]


def found() -> Iterator[tuple[str, Callable[[], Any]]]:
    """Name and value of everything."""
    for name in OURS:
        network = networks()[name]
        yield f"record of {name}", partial(record, network)
        yield f"keys of {name} scenarios", partial(keys, network.model)
        yield f"keys of {name} node files", partial(node_file, network)
        yield f"tables of {name} runs", partial(tables, network)
        yield f"template of {name}", partial(template, name)
    for medium, model in DECLARED.items():
        yield f"keys of own scenarios over {medium}", partial(keys, model)
    for asked in ASKED:
        yield f"usual {asked.__module__}.{asked.__name__}", partial(usual, asked)
    yield "options of commands", lambda: dict(options(app, "innervate"))
    yield "record with nothing said", lambda: record(Network("kind", "package"))
    yield "keys of plan files", partial(keys, PlanFile)
    for job in jobs():
        yield f"who does the job of {job}", partial(entered, job)
    yield "tables of any run", lambda: plain([told(table) for table in simulating.TABLES])
    for nodes in (1, 32, 33, 254):
        yield f"live mesh of {nodes}", partial(live, mesh_parameters, nodes)
    yield "live mesh with changes", lambda: plain(mesh_parameters(9, {"mtu": 64, "e2e_tries": 2}))
    yield "live fence", lambda: plain(fence_parameters(FENCE))
    yield "live radio", partial(live, radio_parameters)
    yield "live skin", partial(live, skin_parameters)
    for name in UP:
        yield f"brought up: {name}", partial(brought_up, name)


def options(group: Any, name: str) -> Iterator[tuple[str, Any]]:
    """For each command what may be given, and what holds where it is not."""
    inner = [word for word in group if not word.startswith("-")]
    for word in inner:
        yield from options(group[word], f"{name} {word}")
    if not inner:
        asked = group.assemble_argument_collection()
        given = {" ".join(one.names): one.field_info.default for one in asked}
        yield name, {key: "needed" if has is Parameter.empty else str(has)
                     for key, has in given.items()}  # fmt: skip


def usual(made: Any) -> dict[str, str]:
    """What of a record holds where nothing else is said."""
    fields = dataclasses.fields(made)
    return {f.name: str(f.default) for f in fields if f.default is not dataclasses.MISSING}


def entered(job: str) -> Any:
    """The settings of each entry of a comparison, and about how long a run of it takes."""
    found = {}
    for one in entries(job):
        run = one.measure if isinstance(one.measure, partial) else partial(one.measure)
        made = [run.func.__qualname__, *run.args, dict(run.keywords)]
        found[one.name] = plain([made, one.cost_s, one.does.__name__])
    return found


def live(parameters: Callable[..., Any], *given: Any) -> Any:
    """The parameters of live nodes whose files change none."""
    return plain(parameters(*given, {}))


def record(network: Network) -> Any:
    """What a network says of itself."""
    numbers = {name: getattr(network, name) for name in ("rank", "link_type", "key_kind")}
    lists = {name: list(getattr(network, name)) for name in ("actions", "harm")}
    words = {"interface_words": plain(network.interface_words), "unfit": network.unfit}
    return numbers | lists | words | {"parts": network.parts}


def keys(model: Any) -> Any:
    """The keys of a table with kinds, ranges, defaults; all that are tables inside it too."""
    (top,), parts = msgspec.json.schema_components([model])
    for part in parts.values():  # as deep as they stand in their class before msgspec 0.23
        if "description" in part:
            part["description"] = inspect.cleandoc(part["description"])
    return {"top": top, **parts}


def node_file(network: Network) -> Any:
    """The keys of a network's node files."""
    table = network.node_file
    return {"roles": list(table.roles), "nodes_max": table.nodes_max, "keys": keys(table)}


def tables(network: Network) -> Any:
    """The tables of a network's runs."""
    return plain([told(table) for table in network.tables])


def told(table: Any) -> Any:
    """A table's columns, as text where they are no data."""
    return {field.name: str(getattr(table, field.name)) for field in dataclasses.fields(table)}


def template(kind: str) -> Any:
    """What a template's scenario comes to."""
    text = scenarios.template(kind)
    return {"text": text.splitlines(), **plans.of(scenarios.loads(text))}


def brought_up(name: str) -> Any:
    """Files of nodes of a scenario, and what happens to them."""
    plan = scenarios.plan(scenarios.load(plans.SMALL / f"{name}.toml"))
    made = networks()[plan.kind].deployment(plan)
    files = {}
    for number in (0, 1, 3, len(made.names) - 1):
        at = [k for k, ends in enumerate(made.links) if number in ends]
        cables = made.in_order(number, at)
        head, tables = made.file(number, cables)
        ports = [made.port_of(number, k) for k in cables] if hasattr(plan, "graph") else []
        files[made.names[number]] = {"cables": cables, "ports": ports, "head": head, **tables}
    events = [(plain(event), play.is_played(event)) for event in play.events(made)]
    about = {"names": made.names, "links": made.links, "channel": made.has_channel}
    return plain(about | {"files": files, "events": events})
