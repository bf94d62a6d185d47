"""The options of the commands that have many, with what `--help` says of each."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal

from cyclopts import Parameter

from innervate.cli.seeds import Seed, Sets, Whole

Flag = Annotated[bool, Parameter(negative="")]
Texts = Annotated[list[str] | None, Parameter(negative="")]
Numbers = Annotated[list[float] | None, Parameter(negative="")]


@dataclass(frozen=True)
class RunOptions:
    """How a scenario runs.

    Parameters
    ----------
    report
        Write report.html as well.
    plain
        Uncompiled, event by event, slow: the same run, for debugging. A network of your own may
        call print(...) and breakpoint() then.
    """

    report: bool = True
    plain: Flag = False


@dataclass(frozen=True)
class SweepOptions:
    """What is varied, how often it runs, and where.

    Parameters
    ----------
    vary
        A key and its values, like protocol.k=2..8, name=a,b or k,m=3:3,5:4; may be given again.
    set_
        Change a key for all runs, as for run.
    repeat
        Runs of every point, each with its own seed; with --until at most.
    seed
        Root seed in place of the scenario's.
    until
        A point ends when the 95 % interval of a mean is that narrow, like
        recoveries.routed_ms.ci=5%; may be given again.
    batch
        Repeats between two decisions of --until; 10 if left out.
    paired
        A key whose variants run on the same seeds, for comparisons; or all.
    out
        Folder to write or to go on in; sweeps/NAME if left out.
    workers
        How many runs at the same time; one for every core if left out.
    engine
        On this machine: processes, threads or here.
    dask
        Address of a Dask scheduler to run on, like tcp://scheduler:8786.
    show
        Figures to show while it runs and at the end, like a,b; may be given again.
    retry
        Run again what failed.
    """

    vary: Texts = None
    set_: Sets = None
    repeat: Whole | None = None
    seed: Seed = None
    until: Texts = None
    batch: Whole | None = None
    paired: Texts = None
    out: Path | None = None
    workers: Whole | None = None
    engine: str = "processes"
    dask: str = ""
    show: Texts = None
    retry: Flag = False

    @property
    def planned(self) -> dict[str, Any]:
        """What of it `sweeping.make_plan` takes."""
        return {
            "vary": self.vary or [], "overrides": self.set_ or [], "repeat": self.repeat,
            "seed": self.seed, "until": self.until or [], "batch": self.batch,
            "paired": self.paired or [],
        }  # fmt: skip

    @property
    def shown(self) -> tuple[str, ...]:
        """The figures of --show, each once."""
        named = (name.strip() for text in self.show or () for name in text.split(","))
        return tuple(dict.fromkeys(name for name in named if name))

    @property
    def how(self) -> dict[str, Any]:
        """What of it `sweeping.sweep` takes of a plan; the folder is its caller's."""
        return {
            "workers": self.workers, "kind": self.engine, "dask": self.dask, "retry": self.retry,
        }  # fmt: skip


@dataclass(frozen=True)
class SizeOptions:
    """What is asked of a robot's skin, and how often it is tried.

    Parameters
    ----------
    links
        Pattern for the links that carry skin: frames of cells, or links with a shape.
    rate
        Samples per second and cell, 250 if left out; may be given again.
    ports
        Numbers of ports to try, like 1..8 or 1,2,4.
    pitch
        Distance of cells on links that have a shape, mm; 25 if left out.
    reach
        Longest cable between two cells, mm; as long as it takes if left out.
    loss
        Samples that may be lost on the way, %.
    recovery
        Time in which all cells must have a way again after a cut, ms.
    repeat
        Runs of every combination.
    seed
        Root seed.
    out
        Folder to write or to go on in; sweeps/size-ROBOT if left out.
    workers
        How many runs at the same time; one for every core if left out.
    dask
        Address of a Dask scheduler to run on.
    json
        Print the answer as JSON and nothing else.
    """

    links: str
    rate: Numbers = None
    ports: str = "1..8"
    pitch: float | None = None
    reach: float | None = None
    loss: float = 1.0
    recovery: float = 50.0
    repeat: Whole = 20
    seed: Seed = None
    out: Path | None = None
    workers: Whole | None = None
    dask: str = ""
    json: Flag = False


@dataclass(frozen=True)
class PageOptions:
    """Where a page is served.

    Parameters
    ----------
    host
        Address to listen at; others than this machine reach 0.0.0.0.
    port
        Port to listen at; 0 is any that is free.
    open_
        Open the page in a browser.
    """

    host: str = "127.0.0.1"
    port: Whole = 0
    open_: Flag = False


@dataclass(frozen=True)
class ExportOptions:
    """Which files are written of a run or scenario; those left out are not.

    Parameters
    ----------
    pcapng
        Capture of all frames, for Wireshark.
    mcap
        Recording of states, touch, routes and alarms, for Foxglove and PlotJuggler.
    rerun
        Recording in space, for the viewer of rerun.io.
    graph
        The network, a file ending in .graphml or .json (node-link).
    tables
        Folder for the run's tables, as Parquet.
    csv
        Tables as CSV instead.
    dissector
        Install the dissector that makes Wireshark read captures.
    from_s
        Capture from this time on, s.
    to_s
        Capture up to this time, s.
    set_
        Change a key of a scenario, as for run.
    seed
        Root seed in place of the scenario's.
    """

    pcapng: Path | None = None
    mcap: Path | None = None
    rerun: Path | None = None
    graph: Path | None = None
    tables: Path | None = None
    csv: Flag = False
    dissector: Flag = False
    from_s: Annotated[float, Parameter(name=["--from"])] = 0.0
    to_s: Annotated[float | None, Parameter(name=["--to"])] = None
    set_: Sets = None
    seed: Seed = None

    @property
    def has_files(self) -> bool:
        """True if something besides the dissector is to be written."""
        return any((self.pcapng, self.mcap, self.rerun, self.graph, self.tables))


Engine = Literal["python", "c", "auto"]


@dataclass(frozen=True)
class UpOptions:
    """How a scenario is brought up as processes.

    Parameters
    ----------
    set_
        Change a key, as for run.
    netns
        Every node in its own network namespace; needs root.
    pty
        Skin: serial cables (ptys) instead of UDP.
    firmware
        Nodes as C on emulated boards (QEMU), where there is such a library of them.
    in_python
        With --firmware: a node that stays in Python, by name; may be given again.
    engine
        What runs the nodes' protocols here: python, c, or auto: C where it can be made.
    sealed
        With a key made for this run.
    identities
        With an identity for each node, made for this run.
    folder
        Where node files, logs and sockets go; a temporary one if left out.
    for_s
        End after so many seconds; 0 = never.
    json
        Say where the nodes are as JSON.
    """

    set_: Sets = None
    netns: Flag = False
    pty: Flag = False
    firmware: Flag = False
    in_python: Annotated[list[str] | None, Parameter(negative="")] = None
    engine: Engine | None = None
    sealed: Flag = False
    identities: Flag = False
    folder: Path | None = None
    for_s: Annotated[float, Parameter(name=["--for"])] = 0.0
    json: Flag = False

    @property
    def cables(self) -> str:
        """What the nodes are joined by."""
        return "netns" if self.netns else "pty" if self.pty else "udp"

    @property
    def keys(self) -> str:
        """What frames are sealed with; "" = they go in the clear."""
        return "key" if self.sealed else "identities" if self.identities else ""


@dataclass(frozen=True)
class SendOptions:
    """How a message is sent.

    Parameters
    ----------
    priority
        Before other messages.
    reliable
        Kept until acknowledged.
    in_order
        Its recipient may put it in order behind those that were sent so before it.
    """

    priority: Flag = False
    reliable: bool = True
    in_order: Flag = False

    @property
    def asked(self) -> dict[str, bool]:
        """What the node is asked for; an older one knows of no order."""
        order = {"in_order": True} if self.in_order else {}
        return {"priority": self.priority, "reliable": self.reliable, **order}


@dataclass(frozen=True)
class VerifyOptions:
    """What to explore, and how much of it.

    Parameters
    ----------
    rule
        Skin: feasible (if left out), strict, paper, paper-lax or all. Radio: practical (if left
        out) or paper.
        Mesh: a failover, search or graph (both if left out), alternate, random or all.
    updates
        periodic, triggered or all.
    graph
        Cables like "pc-1 1-2 2-3", a name (line, star, triangle, ring, pair, complete), or all
        graphs of up to --cells cells. Mesh: links like "0-1 1-2" (0 is the gateway), or a name
        (line, triangle, square, kite, house, spare, prism).
    cells
        How many cells the graphs may have, 1 to 4 (2 if left out); stations of a radio, 2 to 4.
    budget
        How often what may happen, like "ticks=3,counts=2,loss=1,cut=1,heal=1,false=1,restart=1,
        faults=2"; these are the defaults, and faults counts all five kinds together; "ticks=any"
        lets cells tick as often as it takes. Mesh:
        "deaths=1,revivals=0,frames=0,acks=1,ticks=0". One of your own: "loss=1,restart=1,input=1".
    prompt
        Every frame arrives or is lost before anything else happens.
    liveness
        Also see from every state whether routes become shortest once faults have ended.
    starts
        Play that from so many states instead of all.
    states
        End each exploration after so many states.
    walks
        Instead of all states so many random walks, for larger budgets.
    memory
        What the states of an exploration may take, like 800M or 4G.
    random
        Simulate whole networks, all settings and faults drawn, until interrupted.
    mutants
        Try the explorer on copies of the protocols with a small mistake in each: all, or those of
        radio or mesh.
    seed
        With --random the first network's number, with --walks the walks'.
    count
        With --random end after so many networks, with --mutants after so many mutants.
    reduce
        Forget what of a state can no longer matter, and leave out states that others cover.
    plain
        Without the compiler: slower by a hundred times, needs no preparation.
    """

    rule: str = ""
    updates: str = "all"
    graph: str = "all"
    cells: Whole = 0
    budget: str = ""
    prompt: Flag = False
    liveness: bool = True
    starts: Whole = 0
    states: Whole = 0
    walks: Whole = 0
    memory: str = "2G"
    random: Flag = False
    mutants: Flag = False
    seed: Seed = None
    count: Whole = 0
    reduce: bool = True
    plain: Flag = False
