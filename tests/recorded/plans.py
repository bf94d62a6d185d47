"""What scenarios come to before anything runs: their plans, and the words for them."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import Any

from innervate import scenario as scenarios
from innervate.network import networks
from innervate.networks.mesh.scenario.model import MESH_MACS
from innervate.networks.radio.scenario.model import MACS
from innervate.running import fuzz
from innervate.sweeping import planfile
from innervate.sweeping.sweep import make_plan
from tests.recorded import record
from tests.recorded.data import plain

HERE = Path(__file__).resolve().parent
SMALL = HERE / "small"
DRAWN = 24  # networks drawn from a number
POINTS = 4  # of a sweep: the first three and the last
# Small scenarios with other settings, a plan each.
VARIED: dict[str, list[tuple[str, ...]]] = {
    "radio-few": [(f"protocol.mac={mac}",) for mac in MACS] + [
        (f"protocol.mac={mac}", "channel.level=slotted")
        for mac in MACS if mac not in ("token-ring", "polling")
    ] + [("protocol.mode=paper",), ("traffic.kind=saturated",), ("traffic.kind=poisson",)],
    "mesh-near": [(f"radio.mac={mac}",) for mac in MESH_MACS if mac not in ("none", "csma-cd-d1")],
    "mesh-grid": [(f"radio.profile={profile}",) for profile in ("250k", "38k4", "ip", "ideal")] + [
        (f"protocol.failover={way}",) for way in ("search", "alternate", "rssi", "random", "graph")
    ] + [(f"protocol.discovery={way}",) for way in ("list", "tree", "each")] + [
        ("protocol.tables=false",), ("protocol.reliable=false",),
        ("protocol.failover=random", "protocol.avoid=origin"),
    ],
    "skin-patches": [(f"protocol.rule={rule}",)
                     for rule in ("strict", "paper", "paper-lax", "static")] + [
        (f"protocol.updates={updates}",) for updates in ("periodic", "triggered", "wave")
    ] + [("timing.lock_step=true",), ("timing.latency=per_frame",), ("protocol.balancing=false",)],
}  # fmt: skip


def found() -> Iterator[tuple[str, Callable[[], Any]]]:
    """Name and plan of everything."""
    for name, path in sorted(record.sources().items()):
        yield name, partial(of_file, path)
    for path in sorted(SMALL.glob("*.toml")):
        yield f"small {path.stem}", partial(of_file, path)
    for name, settings in VARIED.items():
        for sets in settings:
            path = SMALL / f"{name}.toml"
            yield f"small {name}, {', '.join(sets)}", partial(varied, path, sets)
    for seed in range(DRAWN):
        yield f"drawn {seed}", partial(drawn, seed)
    for path in sorted(record.EXAMPLES.glob("*.toml")):
        if planfile.is_plan(path.read_text(encoding="utf-8")):
            yield f"sweep {path.stem}", partial(sweep, path)


def of_file(path: Path, sets: tuple[str, ...] = ()) -> Any:
    """The plan of a scenario, and what is said of it."""
    return of(scenarios.load(path, sets))


def varied(path: Path, sets: tuple[str, ...]) -> Any:
    """What becomes different in the plan of a scenario with other settings."""
    return beside(of_file(path), of_file(path, sets))


def beside(usual: Any, other: Any) -> Any:
    """What of nested tables is not as it is in others."""
    if not (isinstance(usual, dict) and isinstance(other, dict)):
        return other
    return {key: beside(usual.get(key), inner)
            for key, inner in other.items() if inner != usual.get(key)}  # fmt: skip


def of(scenario: Any) -> Any:
    """The plan of a scenario that was read."""
    network = networks()[scenario.kind]
    made = network.plan(scenario)
    words = network.describe(made).replace(str(HERE.parents[1]), "")
    told = [network.fault_words(made, fault) for fault in made.faults]
    return {
        "words": words.splitlines(), "faults said": plain(told), "loop": network.loop_name(made),
        "unwatchable": network.unwatchable(made), "plan": plain(made),
    }  # fmt: skip


def drawn(seed: int) -> Any:
    """A network drawn from a number, and how many simpler ones there are next to it."""
    tables = fuzz.drawn(seed)
    simpler = [plain(one) for one in fuzz.smaller(tables)]
    return {"tables": plain(tables), "simpler": plain(simpler)} | of(scenarios.from_dict(tables))


def sweep(path: Path) -> Any:
    """The points of a sweep: how many, their seeds, and the scenarios of some."""
    plan = make_plan(path)
    points = plan.points
    shown = [*points[: POINTS - 1], points[-1]]
    return {
        "points": plain([[dict(point.settings), point.columns, point.digest, point.stream]
                         for point in points]),
        "labels": plain([point.label for point in points]),
        "repeats": [plan.repeat, plan.batch, plan.first_block],
        "seeds": [[plan.seed(point, i) for i in (0, 1, plan.repeat - 1)] for point in shown],
        "until": [str(rule) for rule in plan.until],
        "written": planfile.dump(plan).splitlines(),
        "plans": [of(plan.base.scenario(point.settings, plan.seed(point, 0)))["plan"]
                  for point in shown],
    }  # fmt: skip
