"""What the tables of a scenario must hold together, as far as no network is needed to see it."""

from collections.abc import Iterator
from math import ceil

from innervate.networks.skin.scenario.model import K_MAX, CommandTable, EventTable, SkinScenario
from innervate.scenario.actions.cables import TABLE, TARGETS
from innervate.scenario.events import Finding, exact, in_order, in_time, own_keys, refuse
from innervate.scenario.lines import Key
from innervate.scenario.source import Source

ONE = 840  # p_f = 1 in fixed point [skin 5]
# sim/clocks.py computes time_us * drift_ppm * 2^30 / 10^6 in 64 bits with sign: duration_s *
# drift_ppm has to stay below 2^33, less a little for the rounding of the drift.
DRIFT_S_PPM = 8_000_000_000
COMMANDS_MAX = 1_000_000
NAMES = ("interface", "cell", "link", "node", "pc", "random")
# The keys that name a target, and the words for them.
_NAMED = {
    "cable": (
        ("interface", "cell", "link", "node", "random"),
        'a cable: interface = 0, cell = {...} with port = "E", link = [{...}, {...}] or '
        'random = "link"',
    ),
    "cell": (("cell", "node", "random"), 'a cell: cell = {...}, node = "n1" or random = "cell"'),
    "node": (("cell", "node", "pc", "random"), 'a node: pc = true, cell = {...}, node = "n1"'),
}


def check(source: Source, model: SkinScenario) -> None:
    """Raise ScenarioError at the first thing that does not fit together."""
    refuse(source, _findings(source, model))


def _findings(source: Source, model: SkinScenario) -> Iterator[Finding]:
    yield from _origin(model)
    yield from _protocol(source, model)
    yield from _missed(model.protocol.k)
    yield from in_order(("timing", "hop_latency_us"), model.timing.hop_latency_us)
    yield from _clocks(model)
    if 0 < model.data.rate_hz < 0.01:
        yield ("data", "rate_hz"), "data.rate_hz must be 0 (off) or at least 0.01"
    for index, event in enumerate(model.event):
        yield from _event(model, index, event)
    yield from _commands(model)
    if model.touch is not None:
        times = [point[0] for point in model.touch.path]
        for index in range(1, len(times)):
            if times[index] <= times[index - 1]:
                yield (
                    ("touch", "path", index),
                    f"touch.path goes back in time at point {index}: {times[index]:g} s after "
                    f"{times[index - 1]:g} s; put the points in order of time",
                )


def _origin(model: SkinScenario) -> Iterator[Finding]:
    """Exactly one of patches, a free graph and a body; tables of the others stay away."""
    given = [name for name in ("patch", "link", "body") if getattr(model, name)]
    if not given:
        yield (), "there is no skin; add a [[patch]], [[link]]s or a [body]"
    if len(given) > 1:
        yield ((given[1],), f"a skin is made of one of them: {' or '.join(given)}; leave one out")
    if given[0] != "patch":
        extra = "interface" if model.interface else "cable" if model.cable else ""
        instead = '[[link]]s to "pc.0"' if given[0] == "link" else "body.interfaces"
        if extra:
            yield (extra, 0), f"[[{extra}]] goes with [[patch]]; use {instead}"


def _protocol(source: Source, model: SkinScenario) -> Iterator[Finding]:
    protocol = model.protocol
    if protocol.k is not None and protocol.r_f is not None:
        key = "r_f" if ("protocol", "r_f") not in source.sets else "k"
        message = "protocol.k and protocol.r_f say the same thing twice; leave one out"
        yield ("protocol", key), message
    for key, usual in (("balance_periods", None), ("balance_rule", "even")):
        if not protocol.balancing and getattr(protocol, key) != usual:
            message = f"protocol.{key} has no effect with balancing = false; leave one out"
            yield ("protocol", key), message
    yield from in_order(("protocol", "forward_us"), protocol.forward_us)


def _missed(k: int | None) -> Iterator[Finding]:
    """That k missed beacons can be counted: each weighs a whole number of 1/ONE."""
    if k is None or _is_kept(k):
        return
    near = [next(filter(_is_kept, range(k, 0, -1))), *filter(_is_kept, range(k, K_MAX + 1))][:2]
    yield (
        ("protocol", "k"),
        f"protocol.k = {k} cannot be kept: a missed beacon is counted in 1/{ONE}; "
        f"use {' or '.join(map(str, near))}",
    )


def _is_kept(k: int) -> bool:
    return ceil(ONE / ceil(ONE / k)) == k


def _clocks(model: SkinScenario) -> Iterator[Finding]:
    """Refuse a duration in which drifting clocks would leave their range."""
    drift_ppm = 0 if model.timing.lock_step else model.timing.drift_ppm
    if model.duration_s * drift_ppm > DRIFT_S_PPM:
        yield (
            ("duration_s",),
            f"duration_s = {model.duration_s:g} is too long for clocks with timing.drift_ppm = "
            f"{drift_ppm}; make it at most {DRIFT_S_PPM // drift_ppm} or the drift smaller",
        )


def _event(model: SkinScenario, index: int, event: EventTable) -> Iterator[Finding]:
    key: Key = ("event", index)
    name = f"event.{index}"
    yield from in_time(index, event.at_s, model.duration_s, "least, most")
    given = [t for t in NAMES if getattr(event, t) is not None and getattr(event, t) is not False]
    target = TARGETS[event.action]
    allowed, words = _NAMED[target]
    if not given:
        yield key, f'{name} ("{event.action}") has no target; name {words}'
    if len(given) > 1:
        yield (
            (*key, given[1]),
            f"{name} has {len(given)} targets: {' and '.join(given)}; keep one",
        )
    if given[0] not in allowed:
        yield (*key, given[0]), f'{name}: "{event.action}" takes {words}, not {given[0]}'
    if event.random is not None:
        wanted = ("link", "interface") if target == "cable" else ("cell",)
        if event.random not in wanted:
            both = " or ".join(f'"{w}"' for w in wanted)
            message = f'{name}: "{event.action}" draws random = {both}, not "{event.random}"'
            yield (*key, "random"), message
    if event.port is not None and given[0] not in ("cell", "node"):
        yield (*key, "port"), f"{name}.port goes with cell or node, not {given[0]}"
    if event.port is not None and target != "cable":
        yield (*key, "port"), f'{name}: "{event.action}" acts on the whole cell; leave port out'
    if event.action == "loose" and event.loss is None:
        yield key, f'{name} ("loose") lacks "loss"; give it a fraction, like 0.35'
    yield from own_keys(index, event, TABLE)


def _commands(model: SkinScenario) -> Iterator[Finding]:
    count = 0
    for index, table in enumerate(model.command):
        key: Key = ("command", index)
        name = f"command.{index}"
        given = [t for t in ("cell", "node", "random") if getattr(table, t) not in (None, False)]
        if len(given) > 1:
            message = f"{name} has {len(given)} targets: {' and '.join(given)}; keep one"
            yield (*key, given[1]), message
        if table.at_s >= model.duration_s:
            yield (
                (*key, "at_s"),
                f"{name}.at_s = {table.at_s:g} is not before the end; duration_s is "
                f"{model.duration_s:g}",
            )
        if 0 < table.rate_hz < 0.001:
            yield (*key, "rate_hz"), f"{name}.rate_hz must be 0 (once) or at least 0.001"
        if table.cell is not None and table.cell.port is not None:
            yield (*key, "cell"), f"{name}: a command is for the whole cell; leave port out"
        count += commands_of(table, model.duration_s)
        if count > COMMANDS_MAX:
            yield (
                (*key, "rate_hz"),
                f"these are {count:,} commands until the end, of at most {COMMANDS_MAX:,}"
                f"; make {name}.rate_hz smaller",
            )


def commands_of(table: CommandTable, duration_s: float) -> int:
    """How many commands a table makes before the end."""
    if table.rate_hz == 0:
        return 1
    return max(1, ceil((exact(duration_s) - exact(table.at_s)) * exact(table.rate_hz)))
