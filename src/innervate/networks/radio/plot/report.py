"""The part of a report that is about radio."""

from collections import Counter
from collections.abc import Mapping
from typing import Any

import numpy as np

from innervate.analysis.headline import verb
from innervate.kernel.words import number_of
from innervate.networks.radio.analysis import air
from innervate.networks.radio.plot import charts as radio_charts
from innervate.networks.radio.plot import scene as radio_scene
from innervate.networks.radio.plot import timeline as radio_timeline
from innervate.networks.radio.plot import words as told
from innervate.networks.radio.scenario.words import warnings
from innervate.plot import charts, page, svg, words
from innervate.plot.page import ROWS_MAX, details, figure, pictures, section, table, tiles


def body(result: Any, summary: Mapping[str, Any]) -> str:
    """Headline, numbers and pictures of a radio run, as HTML."""
    if summary.get("level") == "slotted":
        found = section("How well it went", slotted_charts(result, summary))
        return slotted_top(result, summary) + "\n" + found
    return page.joined(
        top(result, summary),
        _timelines(result),
        _charts(result, summary),
        page.events(result, told.fault_words),
        _reports(result, summary),
    )


def notebook(result: Any, summary: Mapping[str, Any]) -> str:
    """What a notebook shows of a run, as HTML."""
    if summary.get("level") == "slotted":
        return slotted_top(result, summary) + slotted_charts(result, summary)
    return top(result, summary) + on_air(result)


def top(result: Any, summary: Mapping[str, Any]) -> str:
    """What happened, and the figures to know."""
    params = result.plan.params
    switch = f"in {words.ms_words(params['ta_us'] / 1e3)}" if params["ta_us"] else "at once"
    over = (
        f"{summary['name']}: {number_of(summary['stations'], 'station')} on one radio "
        f"channel, {told.protocol_words(summary['protocol'])}, packets of "
        f"{params['packet_slots']} slots of {params['slot_us']} us, radios that switch {switch}; "
        f"seed {summary['seed']}"
    )
    said = page.paragraphs(sentences(result, summary)) + page.ended_early(summary)
    return page.top(over, summary, said, tiles(_figures(result, summary)))


def sentences(result: Any, summary: Mapping[str, Any]) -> list[str]:
    """What happened, for somebody who knows nothing of it."""
    telling = {"saturated": _saturated, "disaster": _disaster}.get(summary["traffic"], _arrivals)
    return [
        telling(result, summary),
        *told.off_words(summary),
        *warnings(result.plan),
        *_collisions(result, summary),
        _silence(summary),
    ]


def _disaster(result: Any, summary: Mapping[str, Any]) -> str:
    plan, offered = result.plan, summary["offered"] - summary["abandoned"]
    if not offered:
        return f"No robot started in the {summary['duration_s']:g} s of the run."
    starts = [times[0] for times in plan.arrivals if len(times)]
    spread_us = max(starts, default=0) - min(starts, default=0)
    how = f"within {words.ms_words(spread_us / 1e3)}" if spread_us else "at once"
    begin = f"{number_of(offered, 'robot')} started {how}" if offered > 1 else "1 robot started"
    if summary["duration_slots"] is None:
        return f"{begin}; no packet was delivered in {summary['duration_s']:g} s."
    took = told.time_words(summary["duration_slots"], plan.params["slot_us"])
    if summary["delivered"] == offered:
        return f"{begin}; every packet was delivered {took} later."
    missing = offered - summary["delivered"]
    came, end = (
        f"{number_of(summary['delivered'], 'packet')} {verb(summary['delivered'], 'was')}",
        f"{missing:,} {verb(missing, 'was')} not by the end of the run",
    )
    return f"{begin}; {came} delivered within {took}, {end}."


def _saturated(result: Any, summary: Mapping[str, Any]) -> str:
    begin = f"{number_of(summary['stations'], 'robot')} always had something to send"
    if summary["throughput"] is None:
        return f"{begin}; no packet was delivered in {result.ended_us / 1e6:g} s."
    index = summary["jain"]
    split = "shared evenly" if index > 0.99 else "shared unevenly" if index < 0.9 else "shared"
    filled = f"delivered packets filled {words.share_words(summary['throughput'])} of the time"
    return f"{begin}; {filled}, {split} (Jain's index {index:.3f})."


def _arrivals(result: Any, summary: Mapping[str, Any]) -> str:
    expected = summary["offered"] - summary["abandoned"]
    begin = f"{number_of(summary['stations'], 'robot')} had {number_of(expected, 'packet')} to send"
    if not summary["delivered"]:
        return f"{begin}; none was delivered."
    share = words.share_words(summary["delivered"] / expected)
    if summary["delay_slots"]["p50"] is None:
        return f"{begin}; {share} of them were delivered."
    half = told.time_words(summary["delay_slots"]["p50"], result.plan.params["slot_us"])
    return f"{begin}; {share} of them were delivered, half within {half}."


def _collisions(result: Any, summary: Mapping[str, Any]) -> list[str]:
    """Sentences on how many collisions there were, and of how many frames."""
    count, more = summary["collisions"], _taken_for_collided(result)
    if not count:
        return ["No packet collided with another one.", *more]
    found = air.groups(result)
    struck = found.collision
    most = int(found.members[struck].max())
    if count == 1:
        return [f"There was one collision, of {most} frames.", *more]
    return [f"There were {count:,} collisions, of up to {most} frames at once.", *more]


def _taken_for_collided(result: Any) -> list[str]:
    count = air.taken_for_collided(result)
    if not count:
        return []
    which = f"{number_of(count, 'transmission')} that met no other robot's {verb(count, 'was')}"
    return [
        f"{which} taken for collided: a sender cannot tell a collision from an answer that is "
        "missing."
    ]


def _silence(summary: Mapping[str, Any]) -> str:
    """What was lost that nobody knows of."""
    silent = summary["lost_silently"]
    if not silent:
        return "No packet was lost silently."
    who = number_of(silent, "packet")
    return f"Lost silently: {who} that nobody received, taken for delivered by the sender."


def _figures(result: Any, summary: Mapping[str, Any]) -> list[tuple[str, str]]:
    slot, found = result.plan.params["slot_us"], []
    if summary["throughput"] is not None:
        share = words.share_words(summary["throughput"])
        found.append((share, "of the time filled with delivered packets"))
    delay = summary["delay_slots"]
    if delay["p50"] is not None:
        found.append((told.slots_words(delay["p50"]),
                      f"median delay, {words.ms_words(delay['p50'] * slot / 1e3)}"))  # fmt: skip
        found.append((told.slots_words(delay["p99"]), "99 % were delivered within that"))
    if summary["jain"] is not None:
        found.append((f"{summary['jain']:.3f}", "Jain's index of fairness, 1 is even"))
    found.append(
        (f"{summary['collisions']:,}", "collision" if summary["collisions"] == 1 else "collisions")
    )
    return [*found, page.took(summary, result.ended_us / 1e6)]


def on_air(result: Any) -> str:
    """The first collision or transmissions, a lane for each station; "" without any."""
    shown = radio_scene.scene(result)
    return _wide(radio_timeline.draw(shown), "", "") if shown.boxes else ""


def _timelines(result: Any) -> str:
    whole = radio_scene.resolution(result)
    shown = radio_scene.scene(result, *whole)
    if not shown.boxes:
        return ""
    first = "collision" if any(box.collided for box in shown.boxes) else "transmissions"
    text = "A lane for each station; slots count from the first of these frames."
    if shown.cut:
        text += f" Shown are {len(shown.stations)} stations, {len(shown.boxes):,} transmissions."
    head = f"The first {first}, and what followed"
    parts = [_wide(radio_timeline.draw(shown), head, text)]
    begin = radio_scene.beginning(result, whole)
    if begin is not None:
        enlarged = radio_timeline.draw(radio_scene.scene(result, *begin))
        parts.append(_wide(enlarged, "The beginning, enlarged", ""))
    listing = details("The same, event by event", _listing(result, shown))
    return section("On the air", "".join(parts) + listing)


def _wide(drawing: svg.Drawing, head: str, text: str) -> str:
    """A figure that a narrow screen scrolls rather than shrinks."""
    return f'<div class="wide">{figure(drawing, head, text)}</div>\n'


def _listing(result: Any, shown: radio_scene.Scene) -> str:
    """Every start and end of a frame and every report in a scene, as a table."""
    low, high, origin = shown.window
    lines: list[tuple[int, int, str]] = []
    for box in shown.boxes:
        what = f"{box.words.name}{' (collides)' if box.collided else ''}"
        lines += [(box.start_us, box.station, f"{what} begins")]
        lines += [(box.end_us, box.station, f"{what} ends")]
    rows = result.rows[(result.rows["time"] >= low) & (result.rows["time"] < high)]
    protocol = result.plan.protocol
    for row in rows[:ROWS_MAX]:
        what = told.report_words(protocol, int(row["code"]), int(row["a"]), int(row["b"]))
        lines.append((int(row["time"]), int(row["node"]), what))
    lines.sort(key=lambda line: line[:2])
    slot = shown.slot_us
    cells = [
        (f"{(at - origin) / 1e3:.3f}", f"{(at - origin) / slot:.2f}", str(node), svg.clean(what))
        for at, node, what in lines
    ]
    return page.beginning(("ms", "slots", "station", "what"), cells)


def _charts(result: Any, summary: Mapping[str, Any]) -> str:
    if not summary["delivered"]:
        return ""
    disaster = summary["traffic"] == "disaster"
    shown = [
        radio_charts.came(result) if disaster else radio_charts.filled(result),
        radio_charts.delays(result, summary),
        radio_charts.waits(result) if disaster else radio_charts.shares(result, summary),
    ]
    return section("How well it went", pictures([page.panel(one) for one in shown if one], "two"))


def _reports(result: Any, summary: Mapping[str, Any]) -> str:
    """How often stations reported what, and what became of frames and packets."""
    rows = result.rows
    kinds = Counter(
        told.report_kind(code, b)
        for code, b in zip(rows["code"].tolist(), rows["b"].tolist(), strict=True)
    )
    for key, what in (
        ("frame_errors", "frame unreadable at one receiver"),
        ("partial", "packet delivered, but not to everybody"),
        ("duplicates", "packet received a second time"),
    ):
        kinds[what] += summary[key]
    cells = [(svg.clean(name), f"{count:,}") for name, count in kinds.most_common() if count]
    return section("What the stations reported", table(("what", "times"), cells) if cells else "")


def slotted_top(result: Any, summary: Mapping[str, Any]) -> str:
    """What happened on the slotted level, and the figures to know."""
    model = result.plan.scenario.model
    over = (
        f"{summary['name']}: the slotted level, a reference model that counts slots; "
        f"{model.protocol.mac}, packets of {result.plan.params['packet_slots']} slots; "
        f"seed {summary['seed']}"
    )
    who = number_of(summary["stations"], "robot")
    if model.traffic.kind == "disaster" and summary["delivered"] < summary["stations"]:
        count = number_of(summary["delivered"], "packet")
        head = f"{who} started at once; {count} came through in the time."
    elif model.traffic.kind == "disaster":
        after = f"{summary['duration_slots']:.4g} slots later"
        head = f"{who} started at once; every packet was delivered {after}."
    else:
        head = f"{who}: packets filled {words.share_words(summary['throughput'])} of the time."
    found = [
        (words.share_words(summary["throughput"]), "of the time is packets"),
        (f"{summary['jain']:.3f}", "fairness (Jain), 1 is even"),
        (f"{summary['collisions']:,}", "collisions"),
    ]
    said = page.paragraphs([head, *warnings(result.plan)])
    return page.top(over, summary, said, tiles(found))


def slotted_charts(result: Any, summary: Mapping[str, Any]) -> str:
    """Delays and shares of a run on the slotted level, as figures."""
    delays = np.sort(result.found.delay_slots)
    head = "Packets delivered by each station"
    shown: list[charts.Steps | charts.Bars] = [
        charts.Bars(radio_charts.stations(result.found.successes), head)
    ]
    if len(delays):
        x = charts.Axis(0.0, 1.02 * float(max(delays[-1], 1.0)), "slots from offer to end")
        head = "Delay: packets delivered within, %"
        shown.insert(0, charts.distribution(delays, x, head, top=108.0))
    return pictures([page.panel(one) for one in shown], "two")
