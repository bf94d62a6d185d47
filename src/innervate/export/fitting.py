"""A scenario out of a capture, and how well its simulation matches what was captured."""

import tempfile
from pathlib import Path
from typing import Any

from innervate import scenario as scenarios
from innervate.export import capture
from innervate.export.errors import ExportError
from innervate.export.measure import Measured, Way, measure
from innervate.network import networks
from innervate.scenario.emit import to_toml

SETTLE_S = 2.0  # a scenario runs at least so long, for links to be seen
SECONDS_MAX = 60.0
CLEAR = 0.1  # a link on which so many frames come in is no accident
SHOWN = 8


def scenario_of(found: Measured, name: str) -> str:
    """TOML of a scenario with the links, qualities, latencies and loss that were measured.

    Raises:
        ExportError: no scenario can have such a network.
    """
    tables = networks()[found.kind].fit.tables_of(found)
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


def check(text: str, found: Measured) -> tuple[list[str], bool]:
    """Simulate a fitted scenario, measure that as the capture was measured, and compare.

    Returns what to say, a line each, and whether the same links were seen, but for very bad ones.
    """
    plan = scenarios.plan(scenarios.loads(text))
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "fitted.pcapng"
        capture.write(plan, path)
        again = measure(path)
    fit = networks()[found.kind].fit
    captured = {(fit.named(a), fit.named(b)): way for (a, b), way in found.ways.items() if way.got}
    simulated = {
        (fit.named_again(a, plan), fit.named_again(b, plan)): way
        for (a, b), way in again.ways.items() if way.got
    }  # fmt: skip
    shared = sorted(captured.keys() & simulated.keys())
    apart = [abs(captured[key].quality - simulated[key].quality) for key in shared]
    lines = [f"links, each way: {len(captured)} captured, {len(simulated)} simulated, "
             f"{len(shared)} in both"]  # fmt: skip
    missing = _clear(captured, simulated), _clear(simulated, captured)
    for word, keys in zip(("captured only", "simulated only"), missing, strict=True):
        if keys:
            lines.append(f"  {word}: {_named(keys)}")
    faint = (len(captured) - len(shared) - len(missing[0]),
             len(simulated) - len(shared) - len(missing[1]))  # fmt: skip
    if any(faint):
        lines.append(f"  not named, as less than {100 * CLEAR:.0f} % of their frames came in: "
                     f"{faint[0]} captured only, {faint[1]} simulated only")  # fmt: skip
    if apart:
        lines.append(f"quality: apart by {sum(apart) / len(apart):.4f} on average, "
                     f"{max(apart):.4f} at most")  # fmt: skip
    for what, some in (("captured", found), ("simulated", again)):
        low, middle, high = some.delay_us()
        if not high:
            continue
        lines.append(f"delay, {what}: {low:.0f} to {high:.0f} us, median {middle:.0f} us")
    return lines, not any(missing)


def _named(keys: list[Any]) -> str:
    """The first of some ways, and how many more there are."""
    more = f" and {len(keys) - SHOWN} more" if len(keys) > SHOWN else ""
    return ", ".join(f"{a} to {b}" for a, b in keys[:SHOWN]) + more


def _clear(ways: dict[tuple[str, str], Way], others: dict[tuple[str, str], Way]) -> list[Any]:
    """Ways that only one side has, but for those so bad that they may be missed by chance."""
    return sorted(key for key in ways.keys() - others.keys() if ways[key].quality >= CLEAR)
