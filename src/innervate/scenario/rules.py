"""What the tables of a scenario must hold together, as far as no network is needed to see it."""

from __future__ import annotations

from math import ceil

from innervate.scenario.errors import ScenarioError
from innervate.scenario.lines import Key
from innervate.scenario.model import CommandTable, EventTable, SkinScenario
from innervate.scenario.source import Source
from innervate.scenario.times import check_end

ONE = 840  # p_f = 1 in fixed point [skin 5]
K_MAX = 100
# sim/clocks.py computes time_us * drift_ppm * 2^30 / 10^6 in 64 bits with sign: duration_s *
# drift_ppm has to stay below 2^33, less a little for the rounding of the drift.
DRIFT_S_PPM = 8_000_000_000
COMMANDS_MAX = 1_000_000
TARGETS = ("interface", "cell", "link", "node", "pc", "random")
# Targets each action can have, and the words for them.
CABLE_ACTIONS = ("cut", "restore", "loose", "lose")
CELL_ACTIONS = ("kill", "revive")
_TARGETS_OF: dict[str, tuple[tuple[str, ...], str]] = {
    **{
        action: (
            ("interface", "cell", "link", "node", "random"),
            'a cable: interface = 0, cell = {...} with port = "E", link = [{...}, {...}] or '
            'random = "link"',
        )
        for action in CABLE_ACTIONS
    },
    **{
        action: (("cell", "node", "random"), 'a cell: cell = {...}, node = "n1" or random = "cell"')
        for action in CELL_ACTIONS
    },
    "restart": (("cell", "node", "pc", "random"), 'a node: pc = true, cell = {...}, node = "n1"'),
}


def check(source: Source, model: SkinScenario) -> None:
    """Raise ScenarioError at the first thing that does not fit together."""
    _origin(source, model)
    _protocol(source, model)
    _missed(source, model.protocol.k)
    _range(source, ("timing", "hop_latency_us"), model.timing.hop_latency_us)
    _clocks(source, model)
    if 0 < model.data.rate_hz < 0.01:
        raise source.error(("data", "rate_hz"), "data.rate_hz must be 0 (off) or at least 0.01")
    for index, event in enumerate(model.event):
        _event(source, model, index, event)
    _commands(source, model)
    if model.touch is not None:
        times = [point[0] for point in model.touch.path]
        for index in range(1, len(times)):
            if times[index] <= times[index - 1]:
                raise source.error(
                    ("touch", "path", index),
                    f"touch.path goes back in time at point {index}: {times[index]:g} s after "
                    f"{times[index - 1]:g} s; put the points in order of time",
                )


def _origin(source: Source, model: SkinScenario) -> None:
    """Exactly one of patches, a free graph and a body; tables of the others stay away."""
    given = [
        name
        for name, there in (
            ("patch", model.patch),
            ("link", model.link),
            ("body", model.body is not None),
        )
        if there
    ]
    if not given:
        raise source.error((), "there is no skin; add a [[patch]], [[link]]s or a [body]")
    if len(given) > 1:
        raise source.error(
            (given[1],), f"a skin is made of one of them: {' or '.join(given)}; leave one out"
        )
    if given[0] != "patch":
        extra = "interface" if model.interface else "cable" if model.cable else ""
        instead = '[[link]]s to "pc.0"' if given[0] == "link" else "body.interfaces"
        if extra:
            raise source.error((extra, 0), f"[[{extra}]] goes with [[patch]]; use {instead}")


def _protocol(source: Source, model: SkinScenario) -> None:
    protocol = model.protocol
    if protocol.k is not None and protocol.r_f is not None:
        key = "r_f" if ("protocol", "r_f") not in source.sets else "k"
        message = "protocol.k and protocol.r_f say the same thing twice; leave one out"
        raise source.error(("protocol", key), message)
    if not protocol.balancing and protocol.balance_periods is not None:
        message = "protocol.balance_periods has no effect with balancing = false; leave one out"
        raise source.error(("protocol", "balance_periods"), message)
    if not protocol.balancing and protocol.balance_rule != "even":
        message = "protocol.balance_rule has no effect with balancing = false; leave one out"
        raise source.error(("protocol", "balance_rule"), message)
    _range(source, ("protocol", "forward_us"), protocol.forward_us)


def _missed(source: Source, k: int | None) -> None:
    """That k missed beacons can be counted: each weighs a whole number of 1/ONE."""
    if k is None or _is_kept(k):
        return
    near = [next(filter(_is_kept, range(k, 0, -1))), *filter(_is_kept, range(k, K_MAX + 1))][:2]
    raise source.error(
        ("protocol", "k"),
        f"protocol.k = {k} cannot be kept: a missed beacon is counted in 1/{ONE}; "
        f"use {' or '.join(map(str, near))}",
    )


def _is_kept(k: int) -> bool:
    return ceil(ONE / ceil(ONE / k)) == k


def _clocks(source: Source, model: SkinScenario) -> None:
    """That no clock overflows."""
    drift_ppm = 0 if model.timing.lock_step else model.timing.drift_ppm
    if model.duration_s * drift_ppm > DRIFT_S_PPM:
        raise source.error(
            ("duration_s",),
            f"duration_s = {model.duration_s:g} is too long for clocks with timing.drift_ppm = "
            f"{drift_ppm}; make it at most {DRIFT_S_PPM // drift_ppm} or the drift smaller",
        )


def _range(source: Source, key: Key, pair: tuple[float, float]) -> None:
    if pair[0] > pair[1]:
        name = ".".join(str(part) for part in key)
        message = f"{name} must be [least, most], not [{pair[0]:g}, {pair[1]:g}]"
        raise source.error(key, message)


def _event(source: Source, model: SkinScenario, index: int, event: EventTable) -> None:
    key: Key = ("event", index)
    name = f"event.{index}"
    if isinstance(event.at_s, tuple):
        _range(source, (*key, "at_s"), event.at_s)
    earliest = event.at_s[0] if isinstance(event.at_s, tuple) else event.at_s
    latest = event.at_s[1] if isinstance(event.at_s, tuple) else event.at_s
    if earliest < 0:
        message = f"{name}.at_s must be a number of seconds from 0, not {earliest:g}"
        raise source.error((*key, "at_s"), message)
    check_end(source, index, latest, model.duration_s)
    given = [t for t in TARGETS if getattr(event, t) is not None and getattr(event, t) is not False]
    allowed, words = _TARGETS_OF[event.action]
    if not given:
        raise source.error(key, f'{name} ("{event.action}") has no target; name {words}')
    if len(given) > 1:
        raise source.error(
            (*key, given[1]), f"{name} has {len(given)} targets: {' and '.join(given)}; keep one"
        )
    if given[0] not in allowed:
        message = f'{name}: "{event.action}" takes {words}, not {given[0]}'
        raise source.error((*key, given[0]), message)
    if event.random is not None:
        wanted = ("link", "interface") if event.action in CABLE_ACTIONS else ("cell",)
        if event.random not in wanted:
            both = " or ".join(f'"{w}"' for w in wanted)
            message = f'{name}: "{event.action}" draws random = {both}, not "{event.random}"'
            raise source.error((*key, "random"), message)
    if event.port is not None and given[0] not in ("cell", "node"):
        raise source.error((*key, "port"), f"{name}.port goes with cell or node, not {given[0]}")
    if event.port is not None and event.action not in CABLE_ACTIONS:
        message = f'{name}: "{event.action}" acts on the whole cell; leave port out'
        raise source.error((*key, "port"), message)
    _amount(source, key, name, event)


def _amount(source: Source, key: Key, name: str, event: EventTable) -> None:
    if event.action == "loose" and event.loss is None:
        raise source.error(key, f'{name} ("loose") lacks "loss"; give it a fraction, like 0.35')
    if event.action != "loose" and event.loss is not None:
        raise source.error((*key, "loss"), f'{name}.loss goes with "loose", not "{event.action}"')
    if event.action != "lose" and event.frames is not None:
        message = f'{name}.frames goes with "lose", not "{event.action}"'
        raise source.error((*key, "frames"), message)


def _commands(source: Source, model: SkinScenario) -> None:
    count = 0
    for index, table in enumerate(model.command):
        key: Key = ("command", index)
        name = f"command.{index}"
        given = [t for t in ("cell", "node", "random") if getattr(table, t) not in (None, False)]
        if len(given) > 1:
            message = f"{name} has {len(given)} targets: {' and '.join(given)}; keep one"
            raise source.error((*key, given[1]), message)
        if table.at_s >= model.duration_s:
            message = f"{name}.at_s = {table.at_s:g} is not before the end; duration_s is "
            raise source.error((*key, "at_s"), f"{message}{model.duration_s:g}")
        if 0 < table.rate_hz < 0.001:
            message = f"{name}.rate_hz must be 0 (once) or at least 0.001"
            raise source.error((*key, "rate_hz"), message)
        if table.cell is not None and table.cell.port is not None:
            message = f"{name}: a command is for the whole cell; leave port out"
            raise source.error((*key, "cell"), message)
        count += commands_of(table, model.duration_s)
        if count > COMMANDS_MAX:
            message = f"these are {count:,} commands until the end, of at most {COMMANDS_MAX:,}"
            raise source.error((*key, "rate_hz"), f"{message}; make {name}.rate_hz smaller")


def commands_of(table: CommandTable, duration_s: float) -> int:
    """How many commands a table makes before the end."""
    if table.rate_hz == 0:
        return 1
    return max(1, ceil((duration_s - table.at_s) * table.rate_hz))


def check_kind(source: Source, kind: object, known: list[str]) -> str:
    """The kind, if this version runs it.

    Raises:
        ScenarioError: missing or unknown.
    """
    if kind is None:
        raise source.error((), f'the scenario has no kind; add kind = "{known[0]}"')
    if isinstance(kind, str) and kind in known:
        return kind
    *most, last = (f'"{name}"' for name in known)
    one = f"{', '.join(most)} or {last}"
    shown = f'"{kind}"' if isinstance(kind, str) else str(kind)[:40]
    error: ScenarioError = source.error(("kind",), f"kind must be {one}, not {shown}")
    raise error
