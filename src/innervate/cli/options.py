"""The options of the commands that have many; below each is what `--help` says of it."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal

from cyclopts import CoercionError, Parameter

from innervate.cli import errors


def _whole_seed(_type: Any, tokens: Sequence[Any]) -> int:
    """What --seed takes: a library's guess at a number could run another seed than was meant."""
    text = tokens[0].value
    if not (text.isascii() and text.isdigit() and int(text) < 2**63):
        message = f'--seed must be a whole number from 0, below 2^63, not "{text[:40]}"'
        raise errors.UserError(message)
    return int(text)


def _whole(_type: Any, tokens: Sequence[Any]) -> int:
    """A whole number; the library would round 2.5 to another than was meant."""
    text = tokens[0].value.lower()
    try:
        return int(text, 0 if text.startswith(("0x", "0o", "0b")) else 10)
    except ValueError:
        raise CoercionError(token=tokens[0], target_type=int) from None


Whole = Annotated[int, Parameter(converter=_whole)]
Most = Annotated[int, Parameter(converter=_whole, show_default=False)]  # 0 is no limit
Seed = Annotated[int | None, Parameter(converter=_whole_seed)]

_SET = Parameter(name=["--set"], negative="", allow_leading_hyphen=True)
Sets = Annotated[list[str] | None, _SET]
Flag = Annotated[bool, Parameter(negative="")]
Json = Annotated[bool, Parameter(name=["--json"], negative="")]
Texts = Annotated[list[str] | None, Parameter(negative="")]
Numbers = Annotated[list[float] | None, Parameter(negative="")]


@dataclass(frozen=True)
class RunOptions:
    """How a scenario runs, whichever command runs it."""

    report: bool = True
    """Write report.html as well."""
    plain: Flag = False
    (
        "Uncompiled, event by event, slow: the same run, for debugging. A network of your own may\n"
        "call print(...) and breakpoint() then."
    )


@dataclass(frozen=True)
class SweepOptions:
    """What is varied, how often it runs, and where."""

    vary: Texts = None
    """A key and its values, like protocol.k=2..8, name=a,b or k,m=3:3,5:4; may be given again."""
    set_: Sets = None
    """Change a key for all runs, as for run."""
    repeat: Whole | None = None
    """Runs of every point, each with its own seed; with --until at most."""
    seed: Seed = None
    """Root seed in place of the scenario's."""
    until: Texts = None
    (
        "A point ends when the 95 % interval of a mean is that narrow, like\n"
        "recoveries.routed_ms.ci=5%; may be given again."
    )
    batch: Whole | None = None
    """Repeats between two decisions of --until; 10 if left out."""
    paired: Texts = None
    """A key whose variants run on the same seeds, for comparisons; or all."""
    out: Path | None = None
    """Folder to write or to go on in; sweeps/NAME if left out."""
    workers: Whole | None = None
    """How many runs at the same time; one for every core if left out."""
    engine: str = "processes"
    """On this machine: processes, threads or here."""
    dask: str = ""
    """Address of a Dask scheduler to run on, like tcp://scheduler:8786."""
    show: Texts = None
    """Figures to show while it runs and at the end, like a,b; may be given again."""
    retry: Flag = False
    """Run again what failed."""
    json: Flag = False
    """Print the means of every point as JSON and nothing else."""

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
    """What is asked of a robot's skin, and how often it is tried."""

    links: str
    """Pattern for the links that carry skin: frames of cells, or links with a shape."""
    rate: Numbers = None
    """Samples per second and cell, 250 if left out; may be given again."""
    ports: str = "1..8"
    """Numbers of ports to try, like 1..8 or 1,2,4."""
    pitch: float | None = None
    """Distance of cells on links that have a shape, mm; 25 if left out."""
    reach: float | None = None
    """Longest cable between two cells, mm; as long as it takes if left out."""
    loss: float = 1.0
    """Samples that may be lost on the way, %."""
    recovery: float = 50.0
    """Time in which all cells must have a way again after a cut, ms."""
    repeat: Whole = 20
    """Runs of every combination."""
    seed: Seed = None
    """Root seed."""
    out: Path | None = None
    """Folder to write or to go on in; sweeps/size-ROBOT if left out."""
    workers: Whole | None = None
    """How many runs at the same time; one for every core if left out."""
    dask: str = ""
    """Address of a Dask scheduler to run on."""
    json: Flag = False
    """Print the answer as JSON and nothing else."""


@dataclass(frozen=True)
class PageOptions:
    """Where a page is served."""

    host: str = "127.0.0.1"
    """Address to listen at; others than this machine reach 0.0.0.0."""
    port: Whole = 0
    """Port to listen at; 0 is any that is free."""
    open_: Flag = False
    """Open the page in a browser."""


@dataclass(frozen=True)
class ExportOptions:
    """Which files are written of a run or scenario; those left out are not."""

    pcapng: Path | None = None
    """Capture of all frames, for Wireshark."""
    mcap: Path | None = None
    """Recording of states, touch, routes and alarms, for Foxglove and PlotJuggler."""
    rerun: Path | None = None
    """Recording in space, for the viewer of rerun.io."""
    graph: Path | None = None
    """The network, a file ending in .graphml or .json (node-link)."""
    tables: Path | None = None
    """Folder for the run's tables, as Parquet."""
    csv: Flag = False
    """Tables as CSV instead."""
    dissector: Flag = False
    """Install the dissector that makes Wireshark read captures."""
    from_s: Annotated[float, Parameter(name=["--from"])] = 0.0
    """Capture from this time on, s."""
    to_s: Annotated[float | None, Parameter(name=["--to"])] = None
    """Capture up to this time, s."""
    set_: Sets = None
    """Change a key of a scenario, as for run."""
    seed: Seed = None
    """Root seed in place of the scenario's."""

    @property
    def has_files(self) -> bool:
        """True if something besides the dissector is to be written."""
        return any((self.pcapng, self.mcap, self.rerun, self.graph, self.tables))


Engine = Literal["python", "c", "auto"]


@dataclass(frozen=True)
class UpOptions:
    """How a scenario is brought up as processes."""

    set_: Sets = None
    """Change a key, as for run."""
    netns: Flag = False
    """Every node in its own network namespace; needs root."""
    pty: Flag = False
    """Cables: serial lines (ptys) instead of UDP."""
    firmware: Flag = False
    """Nodes as C on emulated boards (QEMU), where there is such a library of them."""
    in_python: Annotated[list[str] | None, Parameter(negative="")] = None
    """With --firmware: a node that stays in Python, by name; may be given again."""
    engine: Engine | None = None
    """What runs the nodes' protocols here: python, c, or auto: C where it can be made."""
    sealed: Flag = False
    """With a key made for this run."""
    identities: Flag = False
    """With an identity for each node, made for this run."""
    folder: Path | None = None
    """Where node files, logs and sockets go; a temporary one if left out."""
    for_s: Annotated[float, Parameter(name=["--for"])] = 0.0
    """End after so many seconds; 0 = never."""
    json: Flag = False
    """Say where the nodes are as JSON."""

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
    """How a message is sent."""

    priority: Flag = False
    """Before other messages."""
    reliable: bool = True
    """Kept until acknowledged."""
    in_order: Flag = False
    """Its recipient may put it in order behind those that were sent so before it."""

    @property
    def asked(self) -> dict[str, bool]:
        """What the node is asked for; an older one knows of no order."""
        order = {"in_order": True} if self.in_order else {}
        return {"priority": self.priority, "reliable": self.reliable, **order}


@dataclass(frozen=True)
class VerifyOptions:
    """What to explore, and how much of it."""

    rule: str = ""
    (
        "Skin: feasible (if left out), strict, paper, paper-lax or all. Radio: practical (if left\n"
        "out) or paper.\n"
        "Mesh: a failover, search or graph (both if left out), alternate, random, rssi, heard or\n"
        "all."
    )
    updates: str = "all"
    """periodic, triggered or all."""
    graph: str = "all"
    (
        'Cables like "pc-1 1-2 2-3", a name (line, star, triangle, ring, pair, complete), or all\n'
        'graphs of up to --cells cells. Mesh: links like "0-1 1-2" (0 is the gateway), or a name\n'
        "(line, triangle, square, kite, house, spare, prism)."
    )
    cells: Most = 0
    """How many cells the graphs may have, 1 to 4 (2 if left out); stations of a radio, 2 to 4."""
    budget: str = ""
    (
        'How often what may happen, like "ticks=3, counts=2, loss=1, cut=1, heal=1, false=1,\n'
        'restart=1, faults=2"; these are the defaults, and faults counts all five kinds together; '
        '"ticks=any"\n'
        "lets cells tick as often as it takes. Mesh:\n"
        '"deaths=1, revivals=0, frames=0, acks=1, ticks=0". One of your own: '
        '"loss=1, restart=1, input=1".'
    )
    prompt: Flag = False
    """Every frame arrives or is lost before anything else happens."""
    liveness: bool = True
    """Also see from every state whether routes become shortest once faults have ended."""
    starts: Most = 0
    """Play that from so many states instead of all."""
    states: Most = 0
    """End each exploration after so many states."""
    walks: Most = 0
    """Instead of all states so many random walks, for larger budgets."""
    memory: str = "2G"
    """What the states of an exploration may take, like 800M or 4G."""
    random: Flag = False
    """Simulate whole networks, all settings and faults drawn, until interrupted."""
    mutants: Flag = False
    (
        "Try the explorer on copies of the protocols with a small mistake in each: all, or those "
        "of\nradio or mesh."
    )
    seed: Seed = None
    """With --random the first network's number, with --walks the walks'."""
    count: Most = 0
    """With --random end after so many networks, with --mutants after so many mutants."""
    reduce: bool = True
    """Forget what of a state can no longer matter, and leave out states that others cover."""
    plain: Flag = False
    """Without the compiler: slower by a hundred times, needs no preparation."""


@dataclass(frozen=True)
class OwnOptions:
    """What a network of one's own is joined by."""

    on: str = "cables"
    """What a network of your own is joined by: cables (if left out), channel or field."""
    over: str = ""
    """On a field: the medium access below it, csma; it sends by itself if left out."""


@dataclass(frozen=True)
class MeasuredOptions:
    """Which nodes and links of a measured network count."""

    network: str | None = None
    (
        'Of a measured mesh: a JSON file as community meshes publish it, lines "A B 0.9 0.7",\n'
        "freifunk/leipzig, or topohub:NAME."
    )
    types: Annotated[list[str] | None, Parameter(consume_multiple=True)] = None
    """Types of its links that count; wifi if left out, --empty-types for all."""
    min_tq: float | None = None
    """Worst quality of a link that counts, 0 to 1; if left out 0.3, or what leaves few enough."""
    around: str | None = None
    """A node as the file calls it: only those about it, nearest first, by their better links."""
    nodes: Whole | None = None
    (
        "At most so many of them, 2 to 254, with --gateways to 2000; around the best connected\n"
        "node if none is named."
    )
    gateways: Whole | None = None
    """So many clusters of at most 254 nodes, each with a gateway and a channel of its own."""

    @property
    def wanted(self) -> dict[str, Any]:
        """What was chosen of the network."""
        chosen = {"types": self.types, "min_tq": self.min_tq, "around": self.around,
                  "nodes": self.nodes, "gateways": self.gateways}  # fmt: skip
        return {key: value for key, value in chosen.items() if value is not None}
