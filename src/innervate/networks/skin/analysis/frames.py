"""Where all frames went: sent, arrived, lost by reason, still on their way."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from innervate.networks.skin.analysis.latency import latency_by_port, latency_ms
from innervate.networks.skin.analysis.summary_keys import Data
from innervate.networks.skin.protocol.constants import COMMAND
from innervate.networks.skin.sim import counters as words
from innervate.sim.cables import wires
from innervate.sim.driver import InvariantBroken
from innervate.sim.tables import column, get
from innervate.sim.wheel import FRESH, NIL

# Blocks of counters, by what they count; with beacons whatever else goes before data.
BLOCKS = {"data frames": 0, "beacons": wires.URGENT_BLOCK, "commands": words.COMMAND_BLOCK}


class FramesLost(InvariantBroken):
    """Frames of a run that went nowhere: a mistake of the simulator, never of the scenario."""


@dataclass(frozen=True, slots=True)
class Traffic:
    """Frames of one class over all cables; a frame counts once for every cable it takes."""

    sent: int  # handed to a port that has a cable
    arrived: int  # reached a node that is on
    lost: dict[str, int]  # by reason: cut, noise, off, queue_full, broken_link
    flying: int  # on a wire at the end of the run
    queued: int  # waiting in a port's queue at the end

    @property
    def missing(self) -> int:
        """0 if every frame is accounted for."""
        gone = self.arrived + sum(self.lost.values())
        return self.sent - gone - self.flying - self.queued


def data_summary(result: Any) -> Data:
    """Tactile samples from cell to PC: sent, delivered, lost by reason, in flight.

    `loss_ratio` is lost / sent; None if none were sent. Latencies: see latency.py.
    """
    counters = result.counters
    traffic = traffic_of(result, "data frames")
    lost_by = dict(traffic.lost)
    lost_by["no_route"] = counters[words.NO_ROUTE]
    lost_by["loop"] = counters[words.LOOPED]
    lost, sent = sum(lost_by.values()), counters[wires.OFFERED]
    return {
        "sent": sent,
        "delivered": counters[wires.DELIVERED],
        "lost": lost,
        "loss_ratio": lost / sent if sent else None,
        "lost_by": lost_by,
        "in_flight": traffic.flying + traffic.queued,
        "latency_ms": latency_ms(result),
        "latency_by_port": latency_by_port(result),
    }


def lost_at_start(result: Any) -> int:
    """Samples lost, for want of a route, by cells that had not had one yet; if observed."""
    early: int = result.counters[words.EARLY]
    return early


def check_conserved(result: Any) -> None:
    """Every frame and every sample is accounted for.

    Raises:
        FramesLost: says how many are not, and of which run.
    """
    data = data_summary(result)
    missing = {what: traffic_of(result, what).missing for what in BLOCKS}
    missing["samples"] = data["sent"] - data["delivered"] - data["lost"] - data["in_flight"]
    wrong = [f"{count} {name}" for name, count in missing.items() if count]
    if wrong:
        seed = result.plan.seed
        raise FramesLost(f"frames not conserved (seed {seed}): {', '.join(wrong)} went nowhere")


def beacon_share(result: Any) -> float | None:
    """Beacon bits over capacity, mean over all directions of all cables; None without cables."""
    graph = result.plan.graph
    directions = int(np.count_nonzero(np.frombuffer(graph.peer, np.int32) >= 0))
    if directions == 0 or result.ended_us == 0:
        return None
    beacons = result.counters[wires.SENT + wires.URGENT_BLOCK]
    return float(beacons * result.plan.wire_us / (directions * result.ended_us))


def traffic_of(result: Any, what: str) -> Traffic:
    """The frames of one of BLOCKS."""
    counters, block = result.counters, BLOCKS[what]
    return Traffic(
        sent=counters[wires.SENT + block],
        arrived=counters[wires.ARRIVED + block],
        lost={name: counters[place + block] for name, place in wires.REASONS.items()},
        flying=len(_live(result.world, block)),
        queued=0 if block == wires.URGENT_BLOCK else _queued(result.world, block),
    )


def under_way(world: Any) -> list[Any]:
    """Commands on a wire or in a queue at the end, as frames."""
    flying = [world.frames[i] for i in _live(world, words.COMMAND_BLOCK)]
    return flying + [frame for frame in queued(world) if number_of(frame, "kind") == COMMAND]


def queued(world: Any) -> Iterator[Any]:
    """The frames that wait at ports at the end."""
    room = int(get(world.run, 0, "queue_frames"))
    buffers = world.buffers
    for end in np.flatnonzero(column(buffers, "queued")).tolist():
        first = int(get(buffers, end, "first"))
        for i in range(int(get(buffers, end, "queued"))):
            yield world.queue[end * room + (first + i) % room]


def number_of(record: Any, name: str) -> int:
    """A field of a record, compiled or plain."""
    return int(record[name] if isinstance(record, np.void) else getattr(record, name))


def _queued(world: Any, block: int) -> int:
    """Frames that wait at ports, of this block."""
    wanted = block == words.COMMAND_BLOCK
    return sum((number_of(frame, "kind") == COMMAND) == wanted for frame in queued(world))


def _live(world: Any, block: int) -> list[int]:
    """Numbers of a block's frames on a wire: slots of the pool that arrive somewhere."""
    first, behind = int(get(world.run, 0, "pool_slots")), int(world.wheel.pool[FRESH])
    events = world.wheel.events[first:behind]
    live = (column(events, "bucket") != NIL) & (column(events, "kind") == block)
    found: list[int] = np.flatnonzero(live).tolist()
    return found
