"""The part of a report that is about a radio run on the slotted level."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from innervate.networks.radio.plot.charts import stations
from innervate.networks.radio.plot.words import robots
from innervate.networks.radio.scenario.words import warnings
from innervate.plot import charts, page, words
from innervate.plot.page import panel, pictures, section, tiles


def body(result: Any, summary: Mapping[str, Any]) -> str:
    """Headline, numbers and pictures, as HTML."""
    return top(result, summary) + "\n" + section("How well it went", charts_of(result, summary))


def top(result: Any, summary: Mapping[str, Any]) -> str:
    """What happened, and the figures to know."""
    model = result.plan.scenario.model
    over = (
        f"{summary['name']}: the slotted level, a reference model that counts slots; "
        f"{model.protocol.mac}, packets of {result.plan.params['packet_slots']} slots; "
        f"seed {summary['seed']}"
    )
    if model.traffic.kind == "disaster" and summary["delivered"] < summary["stations"]:
        count = words.number_of(summary["delivered"], "packet")
        head = f"{robots(summary['stations'])} started at once; {count} came through in the time."
    elif model.traffic.kind == "disaster":
        head = (
            f"{robots(summary['stations'])} started at once; every packet was delivered "
            f"{summary['duration_slots']:.4g} slots later."
        )
    else:
        share = words.share_words(summary["throughput"])
        head = f"{robots(summary['stations'])}: packets filled {share} of the time."
    found = [
        (words.share_words(summary["throughput"]), "of the time is packets"),
        (f"{summary['jain']:.3f}", "fairness (Jain), 1 is even"),
        (f"{summary['collisions']:,}", "collisions"),
    ]
    said = page.paragraphs([head, *warnings(result.plan)])
    return page.top(over, summary, said, tiles(found))


def charts_of(result: Any, summary: Mapping[str, Any]) -> str:
    """Delays and shares, as figures."""
    delays = np.sort(result.found.delay_slots)
    head = "Packets delivered by each station"
    shown: list[charts.Steps | charts.Bars] = [charts.Bars(stations(result.found.successes), head)]
    if len(delays):
        x = charts.Axis(0.0, 1.02 * float(max(delays[-1], 1.0)), "slots from offer to end")
        head = "Delay: packets delivered within, %"
        shown.insert(0, charts.distribution(delays, x, head, top=108.0))
    return pictures([panel(one) for one in shown], "two")
