"""The plan of a run: the graph and whole numbers only. Floats end here."""

from dataclasses import dataclass, field
from fractions import Fraction
from math import ceil, floor

from innervate.networks.skin.scenario.graph import Named, build_graph, check_reach
from innervate.networks.skin.scenario.model import ProtocolTable, SkinScenario
from innervate.networks.skin.scenario.orders import Order, orders
from innervate.networks.skin.scenario.rules import ONE
from innervate.networks.skin.scenario.script import Step, steps
from innervate.networks.skin.scenario.targets import hit, target
from innervate.networks.skin.scenario.touch import Touch, sample
from innervate.scenario.actions.cables import ACTIONS, TABLE
from innervate.scenario.cables import LOSS_ONE, CablesPlan, Fault
from innervate.scenario.events import Harmed, at_us, exact, micros
from innervate.scenario.load import Scenario
from innervate.trace.streams import stream

K = 5
DEPTH_EXPECTED = 32  # MAXD' [skin 4]
DATA_CELLS_MAX = 65_536

RULES = ("feasible", "strict", "paper", "static", "paper-lax")
BALANCE_RULES = ("even", "paper")
UPDATES = ("periodic", "triggered", "wave")


@dataclass(slots=True)
class Plan(CablesPlan):
    """Everything a run needs, as whole numbers."""

    lock_step: bool = False  # all nodes tick at the same moment, without drift
    touch: Touch | None = None  # the touch, or None
    script: tuple[Step, ...] = ()  # steps that replace the clock; empty = free running
    orders: list[Order] = field(default_factory=list)  # commands of the PC, in order of time
    # Hops of every cell to the PC over the whole graph.
    depths: list[int] = field(default_factory=list)

    @property
    def depth_max(self) -> int:
        """Hops of the deepest cell."""
        return max(self.depths)


def plan(scenario: Scenario) -> Plan:
    """The plan of a scenario: same scenario and seed, same plan, on any machine.

    Raises:
        ScenarioError: the scenario's network cannot be built, is too deep or too large.
    """
    model, source = scenario.model, scenario.source
    graph = build_graph(scenario)
    depths = graph.depths().tolist()
    check_reach(source, graph, depths, model.protocol.max_depth)
    if model.data.rate_hz and graph.cells > DATA_CELLS_MAX:
        message = f"{graph.cells:,} cells cannot send data: a data frame numbers {DATA_CELLS_MAX:,}"
        raise source.error(("data", "rate_hz"), f"{message}; set data.rate_hz = 0")
    params, named = parameters(model.protocol, max(depths)), Named(source, graph)
    return Plan(
        scenario=scenario,
        graph=graph,
        kind=scenario.kind,
        seed=scenario.seed,
        duration_us=max(1, micros(model.duration_s)),
        params=params,
        start_us=1 if model.timing.lock_step else params["beacon_us"],
        drift_ppm=0 if model.timing.lock_step else model.timing.drift_ppm,
        latency_us=model.timing.hop_latency_us,
        latency_per_frame=model.timing.latency == "per_frame",
        lock_step=model.timing.lock_step,
        data_period_us=_period_us(model.data.rate_hz) if model.data.rate_hz else 0,
        queue_frames=model.data.queue,
        loss_q15=round(exact(model.timing.loss) * LOSS_ONE),
        faults=_faults(named, model),
        touch=sample(model.touch, graph, model.duration_s) if model.touch is not None else None,
        script=steps(named, model.script) if model.script is not None else (),
        orders=orders(named, model),
        depths=depths,
    )


def parameters(protocol: ProtocolTable, depth_max: int) -> dict[str, int]:
    """The protocol's parameters [skin 5] for a skin whose deepest cell has `depth_max` hops."""
    beacon_us = _period_us(protocol.beacon_hz)
    if protocol.r_f is not None:
        r_f = ceil(ONE * exact(protocol.r_f))
    else:
        r_f = ceil(Fraction(ONE, protocol.k or K))
    r_r = r_f if protocol.r_r is None else max(1, floor(ONE * exact(protocol.r_r)))
    k = ceil(Fraction(ONE, r_f))
    balance = protocol.balance_periods or min(8 * depth_max, 65_535)
    return {
        "rule": RULES.index(protocol.rule),
        "updates": UPDATES.index(protocol.updates),
        "beacon_us": beacon_us,
        "r_f": r_f,
        "r_r": r_r,
        "k": k,
        "max_depth": protocol.max_depth,
        "seq_every": protocol.m or min(k, 5),
        "balance_periods": balance if protocol.balancing else 0,
        "balance_rule": BALANCE_RULES.index(protocol.balance_rule),
        "hold_periods": k + 4 * max(depth_max, DEPTH_EXPECTED),
        "gap_us": protocol.gap_us,
        "skip_us": beacon_us * 6 // 10,
        "restart_us": micros(protocol.restart_s),
        "forward_min_us": protocol.forward_us[0],
        "forward_max_us": protocol.forward_us[1],
    }


def _faults(named: Named, model: SkinScenario) -> list[Fault]:
    draws = [stream(model.seed, f"event/{index}") for index in range(len(model.event))]
    times = [at_us(event, draw) for event, draw in zip(model.event, draws, strict=True)]
    harmed = Harmed(TABLE)
    faults = []
    for index in sorted(range(len(times)), key=lambda i: (times[i], i)):
        event = model.event[index]
        end, node = target(named, index, event, draws[index], harmed)
        harmed.note(event.action, hit(named.graph, end, node))
        loss_q15 = round(exact(event.loss or 0.0) * LOSS_ONE)
        frames = (event.frames or 1) if event.action == "lose" else 0
        action = ACTIONS.index(event.action)
        faults.append(Fault(times[index], action, end, node, loss_q15, frames, index))
    return faults


def _period_us(rate_hz: float) -> int:
    return round(1_000_000 / exact(rate_hz))
