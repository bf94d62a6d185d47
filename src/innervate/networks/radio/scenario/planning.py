"""From a radio scenario to the plan of its run."""

from typing import Any

from innervate.networks.radio.scenario.baselines import Draws, Granted, baseline
from innervate.networks.radio.scenario.model import MACS, RadioScenario
from innervate.networks.radio.scenario.plan import RadioFault, RadioPlan, parameters
from innervate.networks.radio.scenario.rules import pair
from innervate.networks.radio.scenario.traffic import OFFERS_MAX, arrivals, mean_interval_us, sizes
from innervate.scenario.actions.channel import JOIN, KILL, LEAVE, TABLE, WORDS
from innervate.scenario.cables import LOSS_ONE
from innervate.scenario.events import at_us
from innervate.trace.streams import stream


def plan(scenario: Any) -> RadioPlan:
    """The plan of a radio scenario: same scenario and seed, same plan, on any machine.

    Raises:
        ScenarioError: it offers more packets than can be kept.
    """
    model: RadioScenario = scenario.model
    bit_us = round(1_000_000 / model.channel.bit_rate)
    ends_us = duration_us(model)
    _check_offers(scenario, 8 * bit_us, ends_us)
    faults = _faults(model)
    joins = {fault.node for fault in faults if fault.action == JOIN}
    first = {node: next(f.action for f in faults if f.node == node) for node in joins}
    saturated = model.traffic.kind == "saturated"
    wanted = 0
    if not any(fault.action in (KILL, LEAVE) for fault in faults):
        wanted = {"saturated": model.stations * model.traffic.packets, "poisson": 0,
                  "disaster": model.stations}[model.traffic.kind]  # fmt: skip
    return RadioPlan(
        scenario=scenario,
        kind="radio",
        seed=scenario.seed,
        duration_us=ends_us,
        protocol=protocol_name(model),
        stations=model.stations,
        params=_parameters(model, bit_us),
        delays_us=delays(model),
        loss_q15=round(model.channel.loss * LOSS_ONE),
        saturated=saturated,
        wanted=wanted,
        arrivals=arrivals(model, 8 * bit_us, ends_us),
        sizes=sizes(model),
        absent=[int(first.get(i) == JOIN) for i in range(model.stations)],
        faults=faults,
    )


def duration_us(model: RadioScenario) -> int:
    """How long a scenario lasts at most, us."""
    return max(1, round(model.duration_s * 1e6))


def _parameters(model: RadioScenario, bit_us: int) -> dict[str, int]:
    """What the stations of a scenario are set to."""
    protocol = model.protocol
    params = parameters(
        pair(model.packet_slots)[1],
        model.channel.turnaround_us,
        protocol.tau_bounds_us or pair(model.channel.tau_us),
        bit_us=bit_us,
        turns=protocol.turns,
        per_turn=protocol.per_turn,
        wait_us=protocol.wait_us,
    )
    if protocol.mac == "csma-cd-r":
        return params
    return baseline(
        protocol.mac,
        model.stations,
        params,
        Draws(protocol.p, protocol.cw_min, protocol.cw_max, protocol.backoff_slots),
        Granted(protocol.received_by, protocol.answers),
    )


def protocol_name(model: RadioScenario) -> str:
    """What the simulator calls the medium access protocol: "csma-cd-r/paper", "dcf", ..."""
    mac = model.protocol.mac
    assert mac in MACS
    return f"{mac}/{model.protocol.mode}" if mac == "csma-cd-r" else mac


def delays(model: RadioScenario) -> list[list[int]]:
    """Per sender and receiver, the same both ways, us; -1 between hidden pairs."""
    least, most = pair(model.channel.tau_us)
    n = model.stations
    found = [[0] * n for _ in range(n)]
    for i in range(n):
        draw = stream(model.seed, f"delay/{i}")
        for j in range(i):
            found[i][j] = found[j][i] = draw.uniform(least, most)
    for a, b in model.channel.hidden:
        found[a][b] = found[b][a] = -1
    return found


def _check_offers(scenario: Any, slot_us: int, duration_us: int) -> None:
    model: RadioScenario = scenario.model
    if model.traffic.kind == "poisson":
        count = model.stations * duration_us // mean_interval_us(model, slot_us)
        if count > OFFERS_MAX:
            raise scenario.source.error(
                ("traffic", "load"),
                f"about {count:,} packets would be offered, more than {OFFERS_MAX:,}; "
                "shorten duration_s or lower traffic.load",
            )


def _faults(model: RadioScenario) -> list[RadioFault]:
    found = []
    for index, event in enumerate(model.event):
        draw, action = stream(model.seed, f"event/{index}"), WORDS[event.action]
        at = at_us(event, draw)
        node = draw.draw(model.stations) if isinstance(event.station, str) else event.station
        value = (event.frames or 1) if TABLE[action].key == "frames" else 0
        found.append(RadioFault(at, action, node, value, index))
    return sorted(found, key=lambda fault: (fault.at_us, fault.index))
