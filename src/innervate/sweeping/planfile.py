"""Plan files: a sweep in TOML. A file with a top-level `scenario` is one.

```toml
scenario = "skin.toml"            # beside this file, or a bundled name
repeat = 30
until = "recoveries.routed_ms.ci=5%"
paired = ["protocol.rule"]

[set]
data.rate_hz = 0

[vary]
protocol.beacon_hz = [10, 50, 250]
protocol.k = "2..8"

[[zip]]                           # lists that go together
protocol.rule = ["paper", "feasible"]
protocol.updates = ["periodic", "wave"]

[derive]
duration_s = "2 + 100 / protocol.beacon_hz"

[[plot]]
x = "protocol.k"
y = "recoveries.routed_ms"
by = "protocol.beacon_hz"
```
"""

import tomllib
from pathlib import Path
from typing import Annotated, Any, Literal

from msgspec import Meta, Struct, structs, to_builtins

from innervate.scenario import ScenarioError
from innervate.scenario.emit import to_toml
from innervate.scenario.explain import convert
from innervate.scenario.lines import key_lines
from innervate.scenario.source import Source, check_plain
from innervate.sweeping.base import leaves
from innervate.sweeping.errors import SweepError
from innervate.sweeping.vary import Axis, Named, axis, plain, split, values_of

Text = Annotated[str, Meta(min_length=1, max_length=500, description="a text")]
Texts = Annotated[list[Text] | Text, Meta(description="a text or a list of texts")]
Count = Annotated[int, Meta(ge=1, le=1_000_000, description="a whole number from 1 to 1000000")]


class PlotTable(Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """[[plot]]: a figure of the sweep."""

    x: Annotated[str, Meta(description='a column, like "protocol.k"')]
    y: Annotated[str, Meta(description='a column, like "recoveries.routed_ms"')]
    by: Annotated[str, Meta(description='a column, like "protocol.rule"')] = ""
    kind: Annotated[Literal["band", "heat"], Meta(description='"band" or "heat"')] = "band"
    name: Annotated[
        str,
        Meta(pattern=r"^[\w.+-]{0,80}(?![\s\S])", description="a file's name without its ending"),
    ] = ""
    title: Annotated[str, Meta(max_length=200, description="a text")] = ""


class PlanFile(Struct, frozen=True, forbid_unknown_fields=True, kw_only=True):
    """A plan file as it stands."""

    scenario: Annotated[str, Meta(description="a scenario file, or a bundled name")]
    name: Annotated[str, Meta(max_length=200, description="a string of at most 200 characters")] = (
        ""
    )
    seed: Annotated[int, Meta(ge=0, description="a whole number from 0")] | None = None
    repeat: Count | None = None
    batch: Count | None = None
    until: Texts = []
    paired: Texts = []
    set: Annotated[dict[str, Any], Meta(description="a table [set]")] = {}
    vary: Annotated[dict[str, Any], Meta(description="a table [vary]")] = {}
    zip: Annotated[list[dict[str, Any]], Meta(description="tables [[zip]]")] = []
    derive: Annotated[dict[str, Any], Meta(description="a table [derive]")] = {}
    plot: Annotated[list[PlotTable], Meta(description="tables [[plot]]")] = []


def is_plan(text: str) -> bool:
    """Whether a TOML text is a plan rather than a scenario."""
    try:
        return "scenario" in tomllib.loads(text)
    except (ValueError, RecursionError):
        return False


def read(text: str, path: str) -> PlanFile:
    """The plan in a TOML text; `path` is what a ScenarioError calls it, with the line."""
    try:
        raw = tomllib.loads(text)
    except (ValueError, RecursionError) as error:
        raise ScenarioError(f"not valid TOML: {error}", path) from None
    source = Source(path, "", key_lines(text))
    check_plain(source, raw)
    return convert(source, raw, PlanFile)


def scenario_of(plan: PlanFile, folder: str) -> str:
    """The scenario that a plan file names: beside it, else as it stands there."""
    beside = Path(folder) / plan.scenario
    return str(beside) if beside.is_file() else plan.scenario


def axes_of(plan: PlanFile, path: str) -> tuple[Axis, ...]:
    """What a plan file varies, [vary] first; a SweepError where that is no list of values."""
    made = [
        axis((key,), [(value,) for value in listed(value, f"{path}: {key}")], f"{path}: {key}")
        for key, value in leaves(plan.vary, into=dict)
    ]
    for number, table in enumerate(plan.zip):
        where = f"{path}: [[zip]] {number}"
        lists = {key: listed(value, f"{where}: {key}") for key, value in leaves(table, into=dict)}
        made.append(together(lists, where))
    return tuple(made)


def plots_of(plan: PlanFile, path: str) -> tuple[PlotTable, ...]:
    """The figures that a plan file asks for, each with a name of its own, or a SweepError."""
    made: dict[str, PlotTable] = {}
    for number, plot in enumerate(plan.plot):
        name = plot.name or f"plot-{number}"
        if plot.kind == "heat" and not plot.by:
            raise SweepError(f"{path}: [[plot]] {number}: a heat map has two axes, x and by")
        if name in made:
            raise SweepError(f'{path}: [[plot]] {number}: another is called "{name}", too')
        made[name] = structs.replace(plot, name=name)
    return tuple(made.values())


def together(lists: dict[str, list[Any]], where: str) -> Axis:
    """The axis of lists that go together, all of one length, else a SweepError."""
    lengths = {key: len(values) for key, values in lists.items()}
    if len(set(lengths.values())) > 1:
        told = ", ".join(f"{key} has {count}" for key, count in lengths.items())
        raise SweepError(f"{where}: lists that go together are equally long; {told}")
    return axis(tuple(lists), zip(*lists.values(), strict=True), where)


def listed(value: Any, where: str) -> list[Any]:
    """The values of a list, or of a text like "2..8" or "a,b"; a SweepError if it is neither.

    An element { name = "...", value = ... } goes by its name in tables and figures.
    """
    if isinstance(value, str):
        return [v for part in split(value, ",") for v in values_of(part.strip(), where)]
    if not isinstance(value, list | tuple | range):
        raise SweepError(f'{where} must be a list of values, or a text like "2..8"')
    return [
        Named(str(item["name"]), item["value"])
        if isinstance(item, dict) and item.keys() == {"name", "value"}
        else item
        for item in value
    ]


def dump(plan: Any) -> str:
    """A resolved plan as a plan file, for the folder of the results."""
    tables: dict[str, Any] = {"scenario": plan.base.file, "name": plan.name, "seed": plan.root,
                              "repeat": plan.repeat, "batch": plan.batch}  # fmt: skip
    if plan.until:
        tables["until"] = [str(rule) for rule in plan.until]
    if plan.paired:
        tables["paired"] = list(plan.paired)
    tables["set"] = dict(plan.base.settings)
    tables["zip"] = [
        {key: [_element(step[i]) for step in made.steps] for i, key in enumerate(made.keys)}
        for made in plan.axes
    ]
    tables["derive"] = {key: formula.text for key, formula in plan.derived}
    tables["plot"] = [to_builtins(plot) for plot in plan.plots]
    return to_toml({name: value for name, value in tables.items() if value not in ({}, [])})


def _element(value: Any) -> Any:
    return {"name": value.name, "value": plain(value)} if isinstance(value, Named) else value
