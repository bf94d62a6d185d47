"""A scenario out of a capture, and how well its simulation matches what was captured."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Any

from innervate import scenario as scenarios
from innervate.export import capture
from innervate.export.errors import ExportError
from innervate.export.measure import measure
from innervate.export.measured import Measured, Way
from innervate.networks.mesh.scenario.profiles import PROFILES
from innervate.scenario.emit import to_toml

LATENCY_US_MAX = 100_000  # as scenarios have it
DATA_MAX = 90
SETTLE_S = 2.0  # a scenario runs at least so long, for links to be seen
SECONDS_MAX = 60.0
LOOSE_SIGMAS = 4.0  # a cable is loose if it loses more than the others by so many deviations
CLEAR = 0.1  # a link on which so many frames come in is no accident
SHOWN = 8
SPREAD_US = 2.0  # delays of a cable that differ by more are drawn for every frame


def scenario_of(found: Measured, name: str) -> str:
    """TOML of a scenario with the links, qualities, latencies and loss that were measured.

    Raises:
        ExportError: no scenario can have such a network.
    """
    tables = _skin(found) if found.kind == "skin" else _mesh(found)
    head = {"schema": 1, "kind": found.kind, "name": name}
    duration = min(max(SETTLE_S, found.seconds), SECONDS_MAX)
    tables = {key: value for key, value in tables.items() if value or value == 0}
    text = to_toml(head | {"duration_s": round(duration, 3), "seed": 1} | tables)
    try:
        scenarios.plan(scenarios.loads(text))
    except scenarios.ScenarioError as error:
        raise ExportError(
            f"{name}: no scenario has a network like the captured one: {error}"
        ) from None
    return text


def _skin(found: Measured) -> dict[str, Any]:
    ways = {key: way for key, way in found.ways.items() if way.got or way.lost}
    cables = sorted({(min(key, key=_order), max(key, key=_order)) for key in ways}, key=_both)
    if not any(end.startswith("pc.") for pair in cables for end in pair):
        raise ExportError("the PC was not captured: a skin needs its interface ports")
    low, high, per_frame = _latency(list(ways.values()))
    loose = _loose(ways)
    rest = [way for key, way in ways.items() if frozenset(key) not in loose]
    timing: dict[str, Any] = {"loss": round(_loss(rest), 5)}
    if any(way.delays_us for way in ways.values()):
        timing["hop_latency_us"] = [low, high]
    if per_frame:
        timing["latency"] = "per_frame"
    tables: dict[str, Any] = {"link": [{"a": a, "b": b} for a, b in cables], "timing": timing}
    if found.beacon_us:
        tables["protocol"] = {"beacon_hz": round(1e6 / found.beacon_us)}
    tables["data"] = {"rate_hz": round(found.rate_hz)}
    tables["event"] = [
        {"at_s": 0.0, "action": "loose", "loss": round(loss, 4), **_cable(sorted(pair, key=_order))}
        for pair, loss in loose.items()
    ]
    return tables


def _latency(ways: list[Way]) -> tuple[int, int, bool]:
    """Least and greatest hop latency, us, and whether every frame has its own.

    Scenarios draw evenly from a range: it has the captured least and median. A busy computer keeps
    some frames waiting for very long.
    """
    known = [sorted(way.delays_us) for way in ways if way.delays_us]
    per_frame = any(_quantile(delays, 0.99) - _quantile(delays, 0.01) > SPREAD_US
                    for delays in known)  # fmt: skip
    some = [_quantile(delays, 0.5) for delays in known]
    low, high = min(some, default=1.0), max(some, default=1.0)
    if per_frame:
        every = sorted(delay for delays in known for delay in delays)
        low = _quantile(every, 0.01)
        high = 2 * _quantile(every, 0.5) - low
    low_us, high_us = (min(max(1, round(value)), LATENCY_US_MAX) for value in (low, high))
    return low_us, high_us, per_frame


def _quantile(values: list[float], share: float) -> float:
    return values[min(len(values) - 1, int(share * len(values)))]


def _order(end: str) -> tuple[bool, int, int]:
    """Ends in order: the PC's first, then by cell and port."""
    name, _, port = end.partition(".")
    return (name != "pc", 0 if name == "pc" else int(name[1:]), int(port))


def _both(pair: tuple[str, str]) -> tuple[Any, ...]:
    return (*_order(pair[0]), *_order(pair[1]))


def _cable(pair: list[str]) -> dict[str, Any]:
    """A cable as an event names it."""
    a, b = pair
    if a.startswith("pc."):
        return {"interface": int(a[3:])}
    return {"link": [a.split(".")[0], b.split(".")[0]]}


def _loss(ways: list[Way]) -> float:
    lost = sum(way.lost for way in ways)
    return lost / max(1, lost + sum(way.got for way in ways))


def _loose(ways: dict[tuple[Any, Any], Way]) -> dict[frozenset[str], float]:
    """Cables that lose clearly more than all together, and their loss in the worse direction."""
    cables: dict[frozenset[str], list[Way]] = {}
    for key, way in ways.items():
        cables.setdefault(frozenset(key), []).append(way)
    typical = sorted(_loss(both) for both in cables.values())[len(cables) // 2]
    found = {}
    for pair, both in cables.items():
        count, loss = sum(way.got + way.lost for way in both), _loss(both)
        spread = (max(typical, 1e-4) * (1 - typical) / max(1, count)) ** 0.5
        if loss > typical + LOOSE_SIGMAS * spread and loss > 0.01:
            found[pair] = loss
    return found


def _mesh(found: Measured) -> dict[str, Any]:
    nodes = sorted({node for key in found.ways for node in key})
    number = {node: i for i, node in enumerate(nodes)}
    pairs = sorted({(min(key), max(key)) for key in found.ways})
    links = [
        {"a": f"n{a}", "b": f"n{b}", "quality": [_quality(found, a, b), _quality(found, b, a)]}
        for a, b in pairs
    ]
    tables: dict[str, Any] = {"node": [{"name": f"n{node}"} for node in nodes], "link": links}
    tables["radio"] = {"profile": profile_of(found)}
    if found.gateway in number:
        tables["gateway"] = f"n{found.gateway}"
    flows = []
    for flow in found.flows:
        dest: Any = "all" if flow.dest == 255 else "monitor" if flow.dest == 254 else None
        if dest is None and flow.dest not in number:
            continue
        one = {"from": f"n{flow.origin}", "to": dest or f"n{flow.dest}"}
        one |= {"bytes": min(flow.size, DATA_MAX), "count": flow.messages}
        flows.append(one | {"every_s": round(max(flow.every_s, 0.0001), 4),
                            "start_s": round(flow.first_s, 3)})  # fmt: skip
    tables["flow"] = flows
    return tables


def _quality(found: Measured, a: int, b: int) -> float:
    way = found.ways.get((a, b))
    return 0.0 if way is None else round(way.quality, 4)


def profile_of(found: Measured) -> str:
    """The radio whose airtime is nearest to the delays of frames, by their sizes."""
    some = [
        (size, delay)
        for way in found.ways.values()
        for size, delay in zip(way.sizes, way.delays_us, strict=True)
    ]
    if not some:
        return "ip"

    def off(name: str) -> float:
        radio = PROFILES[name]
        return sum(abs(delay - (radio.phy_bytes + size) * radio.byte_ns / 1000)
                   for size, delay in some)  # fmt: skip

    return min(("250k", "38k4", "ip"), key=off)


def check(text: str, found: Measured) -> tuple[list[str], bool]:
    """Simulate a fitted scenario, measure that as the capture was measured, and compare.

    Returns what to say, a line each, and whether the same links were seen, but for very bad ones.
    """
    plan = scenarios.plan(scenarios.loads(text))
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "fitted.pcapng"
        capture.write(plan, path)
        again = measure(path)
    rename = _names(found)
    captured = {(rename[a], rename[b]): way for (a, b), way in found.ways.items() if way.got}
    names = _again(again, plan)
    simulated = {(names[a], names[b]): way for (a, b), way in again.ways.items() if way.got}
    shared = sorted(captured.keys() & simulated.keys())
    apart = [abs(captured[key].quality - simulated[key].quality) for key in shared]
    lines = [f"links, each way: {len(captured)} captured, {len(simulated)} simulated, "
             f"{len(shared)} in both"]  # fmt: skip
    missing = _clear(captured, simulated), _clear(simulated, captured)
    for word, keys in zip(("captured only", "simulated only"), missing, strict=True):
        if keys:
            lines.append(f"  {word}: {', '.join(f'{a} to {b}' for a, b in keys[:SHOWN])}")
    if apart:
        lines.append(f"quality: apart by {sum(apart) / len(apart):.4f} on average, "
                     f"{max(apart):.4f} at most")  # fmt: skip
    for what, some in (("captured", found), ("simulated", again)):
        low, middle, high = some.delay_us()
        if not high:
            continue
        lines.append(f"delay, {what}: {low:.0f} to {high:.0f} us, median {middle:.0f} us")
    return lines, not any(missing)


def _clear(ways: dict[tuple[str, str], Way], others: dict[tuple[str, str], Way]) -> list[Any]:
    """Ways that only one side has, but for those so bad that they may be missed by chance."""
    return sorted(key for key in ways.keys() - others.keys() if ways[key].quality >= CLEAR)


def _names(found: Measured) -> dict[Any, str]:
    """What the fitted scenario calls a node or an end."""
    ends = {end for key in found.ways for end in key}
    return {end: end if found.kind == "skin" else f"n{end}" for end in ends}


def _again(again: Measured, plan: Any) -> dict[Any, str]:
    """What the fitted scenario calls a node or an end of its own capture."""
    ends = {end for key in again.ways for end in key}
    if again.kind == "mesh":
        return {node: plan.names[node] for node in ends}
    graph = plan.graph
    names = {}
    for end in ends:
        name, _, port = end.partition(".")
        names[end] = end if name == "pc" else f"{graph.names[int(name[1:])]}.{port}"
    return names
