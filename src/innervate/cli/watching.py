"""`innervate watch`: a simulation or live nodes as a page in the browser."""

from __future__ import annotations

import asyncio
import threading
import webbrowser
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from cyclopts import Parameter

from innervate.cli import errors
from innervate.cli.options import PageOptions, Seed, Sets
from innervate.cli.progress import Progress, uncompiled

if TYPE_CHECKING:
    from innervate.web.recorded import Recorded
    from innervate.web.source import Source

LIVE = "live"


@dataclass(frozen=True, slots=True)
class Settings:
    """What a scenario is changed by, and how fast it runs."""

    sets: list[str]
    seed: int | None
    speed: float | None


def watch(
    what: str,
    /,
    *nodes: str,
    set_: Sets = None,
    seed: Seed = None,
    speed: float | None = None,
    page: Annotated[PageOptions, Parameter(name="*")] = PageOptions(),
) -> int:
    """Serve a page until Ctrl-C.

    Args:
        what: A scenario, the name of a bundled one, a run folder, or live: nodes that run.
        nodes: With live: names or sockets; all nodes of this user if left out.
        set_: Change a key of the scenario, as for run.
        seed: Root seed in place of the scenario's.
        speed: Seconds of the network per second; 0 is as fast as possible.
        page: Where it is served.
    """
    from innervate.scenario import bundled
    from innervate.web.serve import serve

    if not 0 <= page.port <= 65_535:
        raise errors.UserError(f"--port is 0 to 65535, not {page.port}")
    settings = Settings(set_ or [], seed, speed)
    is_live = what == LIVE  # a folder of that name is ./live
    source: Source
    if speed is not None:
        _check_speed(speed)
    if nodes and not is_live:
        raise errors.UserError(f'"{nodes[0]}" is too much; nodes go with: innervate watch live')
    report: Path | None = None
    if is_live:
        source = _live(list(nodes), settings)
    elif Path(what).is_dir() and what not in bundled():
        source = recorded = _recorded(Path(what), settings)
        report = recorded.report
    else:
        source = _simulated(what, settings)

    def announce(address: str) -> None:
        print(f"Open {address}\nCtrl-C ends it.", flush=True)
        if page.open_:
            # A browser that runs in the terminal would keep the page waiting.
            threading.Thread(target=webbrowser.open, args=(address,), daemon=True).start()

    asyncio.run(serve(source, page.host, page.port, announce, report))
    return 0


def _check_speed(speed: float) -> None:
    from innervate.web.errors import Refused
    from innervate.web.playback import Playback

    try:
        Playback(speed)
    except Refused as error:
        raise errors.UserError(f"--speed: {error}, not {speed:g}") from None


def _simulated(what: str, settings: Settings) -> Source:
    from innervate import scenario as scenarios

    plan = scenarios.plan(scenarios.load(what, settings.sets, settings.seed))
    from innervate.web.simulated import Simulated

    source = Simulated(plan, settings.speed)
    with Progress(uncompiled(plan)):
        source.prepare()
    return source


def _recorded(folder: Path, settings: Settings) -> Recorded:
    from innervate.web.recorded import Recorded, plan_of

    if settings.sets or settings.seed is not None:
        raise errors.UserError("a run is shown as it was; --set and --seed go with a scenario")
    plan = plan_of(folder)
    source = Recorded(folder, plan, settings.speed)
    with Progress(uncompiled(plan)) as progress:
        source.replay(progress)
    return source


def _live(nodes: list[str], settings: Settings) -> Source:
    from innervate.web.errors import WatchError
    from innervate.web.live import Live, find

    if settings.sets or settings.seed is not None or settings.speed is not None:
        raise errors.UserError("nodes run as they are; --set, --seed, --speed are for scenarios")
    try:
        return Live(find(nodes))
    except WatchError as error:
        if nodes or not Path(LIVE).exists():
            raise
        raise errors.UserError(
            f"{error}; what is called live here: innervate watch ./live"
        ) from None
