"""The part of a report that is about skins."""

from collections.abc import Mapping
from typing import Any

from innervate.kernel.words import number_of
from innervate.networks.skin.plot import words as skin_words
from innervate.networks.skin.plot.digest import Digest
from innervate.networks.skin.plot.map import CELLS_MAX, shows_depth
from innervate.plot import page, svg, words
from innervate.plot.page import ROWS_MAX, element, keys, panel, pictures, section, table, tiles
from innervate.plot.theme import SHADES

SENTENCES_MAX = 3
BROKEN_MAX = 12
TOUCH = "Touch as the PC received it"


def body(result: Any, summary: Mapping[str, Any]) -> str:
    """Headline, status, numbers and pictures of a skin's run, as HTML."""
    digest = Digest(result, summary)
    return page.joined(
        top(digest), _recovery(digest), _touch(digest), _traffic(digest), _events(digest)
    )


def notebook(result: Any, summary: Mapping[str, Any]) -> str:
    """What a notebook shows of a run, as HTML."""
    digest = Digest(result, summary)
    return top(digest) + maps(digest)


def top(digest: Digest) -> str:
    """What happened, what is broken, and the figures to know."""
    summary, graph = digest.summary, digest.graph
    over = (
        f"{summary['name']}: a robot skin of {number_of(graph.cells, 'cell')}, "
        f"{number_of(graph.interfaces, 'interface port')}, at most "
        f"{number_of(summary['depth_max'], 'hop')} deep; {summary['duration_s']:g} s, "
        f"seed {summary['seed']}"
    )
    warned = page.paragraphs((f"Warning: {text}." for text in summary["warnings"]), "status bad")
    said = page.paragraphs(_sentences(digest)) + page.ended_early(summary)
    return page.top(over, summary, warned, said, _broken(summary), tiles(_figures(digest)))


def _sentences(digest: Digest) -> list[str]:
    """The worst event first, then others in order of time."""
    lines = [digest.headline(incident) for incident in digest.incidents]
    if not lines:
        routed = digest.summary["start_up"]["routed_ms"]
        if routed is None:
            return ["Not every cell found a way to the PC."]
        return [f"Nothing was broken; every cell had a way {words.ms_words(routed)} after start."]
    hero = digest.hero
    first = digest.incidents.index(hero) if hero is not None else 0
    others = [line for i, line in enumerate(lines) if i != first]
    more = len(others) - SENTENCES_MAX
    tail = [f"And {number_of(more, 'more event')}, listed below."] if more > 0 else []
    return [lines[first], *others[:SENTENCES_MAX], *tail]


def _broken(summary: Mapping[str, Any]) -> str:
    """Which cable is broken, and since when: the first question of every skin lab."""
    broken = summary["broken"]
    if not broken:
        return element("p", "No cable is broken at the end.")
    lines = skin_words.broken_cables(broken)
    shown = lines[:BROKEN_MAX]
    if len(lines) > BROKEN_MAX:
        shown.append(f"and {len(lines) - BROKEN_MAX} more, listed under All numbers")
    head = f"Broken at the end: {shown[0]}" if len(shown) == 1 else "Broken at the end:"
    items = "".join(element("li", line) for line in shown) if len(shown) > 1 else ""
    inside = f"{svg.clean(head)}{f'<ul>{items}</ul>' if items else ''}"
    return f'<div class="status bad">{inside}</div>'


def _figures(digest: Digest) -> list[tuple[str, str]]:
    summary = digest.summary
    data, found = summary["data"], []
    early = summary["lost_at_start"] or 0  # no loss to the headline either
    if sent := data["sent"] - early:
        share = words.share_words(1 - (data["lost"] - early) / sent)
        found.append((share, f"of the samples not lost{' after the start' if early else ''}"))
    if data["latency_ms"]["p99"] is not None:
        half = words.ms_words(data["latency_ms"]["p50"])
        text = f"from sensor to PC for 99 % of those received, {half} for half"
        found.append((words.ms_words(data["latency_ms"]["p99"]), text))
    if summary["balance_factor"] is not None and len(summary["port_loads"]) > 1:
        found.append((f"{summary['balance_factor']:.3f}", "balance of the ports, 1 is even"))
    if summary["beacon_share"] is not None:
        found.append((words.share_words(summary["beacon_share"]), "of the wire goes to beacons"))
    loops = summary["loops"]
    longest = loops["longest_ms"]
    note = "" if longest is None else f", the longest {words.stood_words(longest)}"
    found.append((f"{loops['episodes']:,}", f"forwarding loops{note}"))
    done_s = summary.get("interrupted_at_s", summary["duration_s"])
    return [*found, page.took(summary, done_s)]


def maps(digest: Digest) -> str:
    """The skin before, during and after the worst event, and what the colours mean."""
    panels = digest.maps()
    columns = "four" if len(panels) > 1 and not digest.sheet.wide else "two"
    return pictures([panel(one) for one in panels], columns) + keys(legend(digest))


def _recovery(digest: Digest) -> str:
    charts = [panel(one) for one in (*digest.zooms(), *digest.overview())]
    head = "The recovery" if digest.hero is not None else "The skin"
    return section(head, maps(digest) + pictures(charts, "two"))


def _touch(digest: Digest) -> str:
    images = digest.images()
    if not images:
        return section(TOUCH, page.paragraphs(skin_words.unkept(digest.result)))
    period = words.ms_words(digest.plan.data_period_us / 1e3)
    text = f"Every cell measures once in {period}; shown is what came in 1.25 times that."
    if digest.plan.touch is None:
        text += " Nothing touches this skin."
    shown = pictures([panel(one) for one in images], "two" if digest.sheet.wide else "three")
    return section(TOUCH, element("p", text, "note") + shown + keys(touch_legend(digest)))


def touch_legend(digest: Digest) -> list[tuple[svg.Drawing, str]]:
    """What the shades and signs of a picture of what was received mean."""
    entries = [(_icon("none", crossed=True), "nothing received in that time")]
    if digest.plan.touch is not None:
        force = digest.plan.touch.force_mn / 1e3
        entries.insert(0, (_ramp("h"), f"0 to {force:g} N"))
        entries.append((_icon("touch", circle=True), "where the touch really is"))
    return entries


def _traffic(digest: Digest) -> str:
    panels = [digest.loads(), digest.losses()]
    return section(
        "Load and losses",
        pictures([panel(one) for one in panels if one is not None], "two")
        + _latencies(digest.summary["data"])
        + _commands(digest.summary["commands"]),
    )


def _commands(commands: Mapping[str, Any]) -> str:
    """What became of the PC's commands."""
    if not commands["sent"]:
        return ""
    rows = [("reached", f"{commands['delivered']:,}")]
    rows += [
        (f"not reached: {skin_words.MISSED[why]}", f"{count:,}")
        for why, count in commands["lost_by"].items()
    ]
    rows.append(("on their way at the end", f"{commands['in_flight']:,}"))
    if commands["delivered"]:
        times = _times(commands["latency_ms"])
        names = ("half within", "95 % within", "99 % within", "slowest")
        rows += [
            (f"from PC to cell, {name}", took) for name, took in zip(names, times, strict=True)
        ]
    text = (
        f"{number_of(commands['sent'], 'command')} of the PC, for "
        f"{commands['addressed']:,} cells in all; nobody acknowledges one."
    )
    return table(("commands down", "cells"), rows) + element("p", text, "note")


def _latencies(data: Mapping[str, Any]) -> str:
    """How long samples took to every interface port."""
    ports = [one for one in data["latency_by_port"] if one["samples"]]
    if not ports:
        return ""
    rows = [("all ports", f"{data['delivered']:,}", *_times(data["latency_ms"]))]
    rows += [
        (f"port {one['port']}", f"{one['samples']:,}", *_times(one["latency_ms"]))
        for one in ports[:ROWS_MAX]
    ]
    head = ("received at", "samples", "half within", "95 % within", "99 % within", "slowest")
    text = "How long samples took from the sensor to the PC; lost ones took for ever."
    return table(head, rows) + element("p", text, "note")


def _times(latency: Mapping[str, Any]) -> list[str]:
    return [words.ms_words(latency[name]) for name in ("p50", "p95", "p99", "max")]


def _events(digest: Digest) -> str:
    rows = []
    for incident in digest.incidents:
        recovery = incident.recovery
        times = [_ms(recovery[key]) for key in ("detected_ms", "others_ms", "converged_ms")]
        if recovery["others_ms"] == 0:
            times[1] = "had one all the time"
        what = svg.clean(skin_words.fault_words(digest.graph, incident.fault))
        counts = [f"{recovery[key]:,}" for key in ("cut_cells", "cut_off_total")]
        rows.append((f"{recovery['at_s']:.3f} s", what, *counts, *times))
    if not rows:
        return ""
    head = ("at", "what", "cells behind it", "cut off", "noticed after",
            "all others had a way after", "last change after")  # fmt: skip
    return section("Events", page.beginning(head, rows, ", in summary.json"))


def _ms(value: float | None) -> str:
    return "-" if value is None else words.ms_words(value)


def legend(digest: Digest) -> list[tuple[svg.Drawing, str]]:
    """What the colours and lines of the maps mean: samples with words."""
    interfaces, cells = digest.graph.interfaces, digest.graph.cells
    if cells > CELLS_MAX:
        return [
            (_ramp("d"), "mean hops to the PC, few to many; a square stands for several cells"),
            (_icon("none", crossed=True), "some or all of its cells have no way to the PC"),
        ]
    entries: list[tuple[svg.Drawing, str]] = []
    if shows_depth(interfaces):
        entries.append((_ramp("d"), "hops to the PC, few to many"))
    else:
        entries += [(_icon(f"cell p{i}"), f"served by port {i}") for i in range(interfaces)]
    entries.append((_icon("tree", line=True), "to the parent"))
    entries.append((_icon("none", crossed=True), "no way to the PC"))
    if digest.incidents:
        entries.append((_icon("cut", line=True), "cut cable"))
    return entries


def _icon(
    kind: str, crossed: bool = False, line: bool = False, circle: bool = False
) -> svg.Drawing:
    """A small sample for a legend."""
    drawing = svg.Drawing(22, 18, "")
    if line:
        drawing.path("M2,9h18", kind)
        return drawing
    if circle:
        drawing.circle((11, 9), 7, kind)
        return drawing
    corners = [(0, -8), (7, -4), (7, 4), (0, 8), (-7, 4), (-7, -4)]
    drawing.path(svg.polygon(11, 9, corners), kind)
    if crossed:
        drawing.path(svg.cross(11, 9, 2.6), "lack")
    return drawing


def _ramp(letter: str) -> svg.Drawing:
    drawing = svg.Drawing(8 * SHADES, 14, "")
    for i in range(SHADES):
        drawing.rect((8 * i, 1), (8, 12), f"{letter}{i}")
    return drawing
