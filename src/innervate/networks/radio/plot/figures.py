"""Figures of a radio run, for `Run.plot`: timeline, delay, fairness, throughput."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

from matplotlib.figure import Figure

from innervate.networks.radio.analysis import airtime
from innervate.networks.radio.analysis import summary as radio
from innervate.networks.radio.plot import charts
from innervate.networks.radio.plot import timeline as radio_timeline
from innervate.networks.radio.plot.scene import scene
from innervate.plot import paint
from innervate.plot.figures import chart


def timeline(run: Any, from_us: int | None = None, to_us: int | None = None) -> Figure:
    """Who sends when; by default the first collision and its resolution."""
    return paint.figure(radio_timeline.draw(scene(run.result, from_us, to_us)))


def delay(run: Any) -> Figure:
    """Share of the packets delivered within a delay."""
    found = charts.delays(run.result, radio.summarize(run.result))
    return chart(found, "no packet was delivered")


def fairness(run: Any) -> Figure:
    """Packets that each station got through, against the even share."""
    return chart(charts.shares(run.result, radio.summarize(run.result)))


def throughput(run: Any, bins: int = charts.BINS) -> Figure:
    """Share of the time that delivered packets fill, over the run, and the scenario's events."""
    filled, mean = charts.filled(run.result, bins), airtime.throughput(run.result)
    if mean is None:
        return chart(filled)
    head = f"Share of the time, %; dashed: throughput {mean:.3f}"
    return chart(replace(filled, head=head, even=100 * mean))


FIGURES: dict[str, Callable[..., Figure]] = {
    "timeline": timeline, "delay": delay, "fairness": fairness, "throughput": throughput,
}  # fmt: skip
