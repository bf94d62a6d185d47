"""What scenarios of declared networks have in common, whatever medium their nodes are on."""

import math
from collections.abc import Callable, Iterable, Iterator
from operator import itemgetter
from typing import Annotated, Any

from msgspec import Meta

from innervate.network import Network, networks
from innervate.scenario.cables import Happening, Input
from innervate.scenario.errors import ScenarioError
from innervate.scenario.events import exact, in_time, refuse
from innervate.scenario.explain import alternatives, nearest
from innervate.scenario.keys import Name, Scenario, Table, above_0, number, whole
from innervate.scenario.lines import Key
from innervate.scenario.source import Source, shown, with_article
from innervate.topology import Graph, TopologyError, free_graph

INPUTS_MAX = 1_000_000
Numbers = int | list[int]


class InputTable(Table, frozen=True, kw_only=True):
    """What a node is given by its user.

    Attributes:
        at_s: when first, s.
        kind: as the protocol's `on_input` has it.
        node: its number; every node if left out.
        every_s: again after so long, s; 0 = once.
        item: fields of a frame.
    """

    at_s: Annotated[float, number("seconds", 0)] = 0.0
    kind: Annotated[int, whole("", 0, 1 << 20)] = 1
    node: Annotated[int, whole("", 0)] | None = None
    every_s: Annotated[float, number("seconds", 0)] = 0.0
    item: dict[str, Numbers] = {}  # noqa: RUF012


class ScriptTable(Table, frozen=True, kw_only=True):
    """[script]: an order of events in place of the clock, as `innervate verify --out` writes it.

    Attributes:
        steps: an event each, as a story says it.
        graph: on the air: who hears whom, as --graph of `innervate verify` has it.
    """

    steps: Annotated[list[str], Meta(max_length=100_000, description="a list of events")]
    graph: str = ""


class Declared(Scenario, frozen=True, kw_only=True):
    """The keys that scenarios of all media begin with."""

    name: Name = "network"
    duration_s: Annotated[float, above_0("seconds", 1e6)] = 1.0


def check(
    source: Source,
    model: Any,
    nodes: int,
    actions: Iterable[str],
    target: Callable[[Key, Any], None] | None = None,
    graph: Graph | None = None,
) -> None:
    """What single keys do not show and all media have: parameters, inputs, a script, events.

    Args:
        source: for the errors.
        model: the scenario.
        nodes: how many there are.
        actions: of the medium; an event's is one of them, or the network's own.
        target: refuses what an event at a key cannot happen to, before its node is looked at;
            None = it is a node.
        graph: over cables, of the nodes.

    Raises:
        ScenarioError: the first thing that cannot be.
    """
    network = networks()[model.kind]
    check_values(source, ("protocol",), model.protocol, network.fields.PARAMS)
    for place, node in enumerate(getattr(model, "absent", ())):
        check_node(source, ("absent", place), node, nodes)
    check_script(source, model, graph)
    for place, given in enumerate(model.input):
        refuse(source, in_time(place, given.at_s, model.duration_s, table="input"))
        check_node(source, ("input", place, "node"), given.node, nodes)
        check_values(source, ("input", place, "item"), given.item, network.fields.FRAME)
    known = [*actions, *(network.happenings if network.has("happenings") else ())]
    for place, event in enumerate(model.event):
        key: Key = ("event", place)
        _check_action(source, (*key, "action"), event.action, known)
        refuse(source, in_time(place, event.at_s, model.duration_s))
        if target is not None:
            target(key, event)
        check_node(source, (*key, "node"), event.node, nodes)


def _check_action(source: Source, key: Key, action: str, known: list[str]) -> None:
    if action not in known:
        raise source.error(key, f"action must be {alternatives(known)}, not {shown(action)}")


def script_of(plan: Any) -> ScriptTable | None:
    """The script of a plan; None = it has a clock."""
    found = getattr(plan.scenario.model, "script", None)
    return found if isinstance(found, ScriptTable) else None


def script_lines(plan: Any) -> Iterator[str]:
    """That a plan has a script, in a line of what `check` prints."""
    if (script := script_of(plan)) is not None:
        steps = "1 step" if len(script.steps) == 1 else f"{len(script.steps):,} steps"
        yield f"  script     {steps} in place of the clock"


def refuse_script(plan: Any) -> None:
    """Refuse to let time pass where a script replaces the clock.

    Raises:
        ScenarioError: the plan has one.
    """
    if script_of(plan) is not None:
        what = "its [script] replaces the clock; only innervate run and sweep play it"
        raise plan.scenario.source.error(("script",), what)


def check_script(source: Source, model: Any, graph: Graph | None = None) -> None:
    """That a script has a graph of its nodes (`graph` over cables), and nothing happens beside it.

    Raises:
        ScenarioError: the first thing that cannot be.
    """
    if model.script is None:
        return
    for name in ("event", "input", "robot"):
        if getattr(model, name, None):
            what = f"a [script] says all that happens; leave the [[{name}]]s out"
            raise source.error((name, 0), what)
    if graph is None:
        try:
            graph = cabled(model.script.graph)
        except TopologyError as error:
            raise source.error(("script", "graph"), f"script.graph: {error}") from None
        if graph.cells != model.nodes:
            what = f"script.graph has {graph.cells} nodes, and nodes is {model.nodes}"
            raise source.error(("script", "graph"), what)


def cabled(text: str) -> Graph:
    """The graph of cables like "n0.E-n1.W n1-n2".

    Raises:
        TopologyError: no such cables.
    """
    return free_graph([pair.partition("-")[::2] for pair in text.split()])


def parameters(fields: Any, given: dict[str, int]) -> dict[str, int]:
    """All parameters of a protocol: what is given, or as `fields.DEFAULTS` has them, or the value
    in range nearest 0.
    """
    usual = getattr(fields, "DEFAULTS", {})
    return {
        name: given.get(name, usual.get(name, min(max(0, low), high)))
        for name, _length, low, high, *_ in fields.PARAMS
    }


def check_values(source: Source, key: Key, given: dict[str, Any], declared: Any) -> None:
    """Names and ranges of values for declared fields.

    Raises:
        ScenarioError: the first that is none, or out of its range.
    """
    known = {name: (length, low, high, unit) for name, length, low, high, unit, _ in declared}
    for name, value in given.items():
        if name not in known:
            hint = nearest(name, list(known)) if known else "; it has none"
            raise source.error((*key, name), f"{key[0]} has no {shown(name)}{hint}")
        length, low, high, unit = known[name]
        values = value if isinstance(value, list) else [value]
        if (length and (not isinstance(value, list) or len(value) != length)) or (
            not length and isinstance(value, list)
        ):
            many = f"{length} numbers" if length else "one number"
            raise source.error((*key, name), f"{name} must be {many}, not {shown(value)}")
        if not all(low <= one <= high for one in values):
            what = f"{name} must be {low} to {high} {unit}, not {shown(value)}"
            raise source.error((*key, name), what)


def check_node(source: Source, key: Key, node: int | None, nodes: int) -> None:
    """That there is a node of this number, if one is named.

    Raises:
        ScenarioError: there is none.
    """
    if node is not None and not 0 <= node < nodes:
        raise source.error(key, f"there is no node {node}; they are 0 to {nodes - 1}")


def inputs_of(model: Any, network: Network, nodes: int, actions: tuple[str, ...]) -> list[Input]:
    """What nodes are given, repeated and for every node, in order of time.

    The network's `happenings` are among them: all events that are none of these `actions`.

    Raises:
        ScenarioError: more inputs than can be held.
    """
    found: list[Input] = []
    for given in model.input:
        period = given.every_s or model.duration_s
        times = math.ceil((exact(model.duration_s) - exact(given.at_s)) / exact(period))
        who = range(nodes) if given.node is None else [given.node]
        if len(found) + times * len(who) > INPUTS_MAX:
            what = f"more than {INPUTS_MAX:,} inputs; make every_s longer or the run shorter"
            raise ScenarioError(what)
        found += [Input(round(1e6 * (given.at_s + k * period)), node, given.kind, dict(given.item))
                  for k in range(times) for node in who]  # fmt: skip
    for event in model.event:
        if event.action not in actions:
            kind, item = network.happenings[event.action](event.node, event.value)
            found.append(Happening(round(1e6 * event.at_s), event.node, kind, dict(item)))
    return sorted(found, key=lambda one: one.at_us)


def own_events(plan: Any) -> list[tuple[int, str]]:
    """The events of a plan that are its network's own, by time: when (us), and in words."""
    network = networks()[plan.kind]
    own = set(network.happenings if network.has("happenings") else ()) - set(network.actions)
    if not own:
        return []
    label = plan.graph.label if hasattr(plan, "graph") else "node {}".format
    found = [
        (round(1e6 * event.at_s), f"{event.action} {label(event.node)}, value {event.value}")
        for event in plan.scenario.model.event if event.action in own
    ]  # fmt: skip
    return sorted(found, key=itemgetter(0))


def own_lines(plan: Any) -> list[tuple[int, str]]:
    """The same, with their times in words: "at 0.6 s poke n3, value 1"."""
    return [(at_us, f"at {at_us / 1e6:g} s {words}") for at_us, words in own_events(plan)]


def parameter_lines(network: Network) -> Iterator[str]:
    """Every parameter of a protocol as a line of a scenario, with its range and meaning."""
    width = max((len(name) for name, *_ in network.fields.PARAMS), default=0)
    values = parameters(network.fields, {})
    for name, _length, low, high, unit, meaning in network.fields.PARAMS:
        yield f"{name:{width}} = {values[name]}  # {low} to {high} {unit}: {meaning}"


def template(network: Network, model: type, where: str, settings: Iterable[str]) -> str:
    """A scenario to start from; "" for a network whose scenarios are not of this `model`."""
    if network.model is not model:
        return ""
    head = [f"# {with_article(network.name).capitalize()} {where}.", f'kind = "{network.name}"']
    return "\n".join([*head, *settings, "", "[protocol]", *parameter_lines(network), ""])
