"""The gateway dies: what is lost without a standby, and how soon all have tables of one."""

from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from innervate.networks.mesh.analysis.messages import DELIVERED, messages
from innervate.networks.mesh.analysis.summary import summarize
from innervate.networks.mesh.papers import testbed as beds
from innervate.networks.mesh.papers.document import beyond, ours
from innervate.networks.mesh.papers.testbed import GATEWAY, MeshTestbed, Options
from innervate.networks.mesh.protocol.constants import DATA, END_TO_END, MONITOR
from innervate.networks.mesh.scenario.plan import Offer
from innervate.networks.mesh.sim.simulate import simulate
from innervate.papers import drawing
from innervate.papers.experiment import Claim, Claims, Measured, Point, verdict
from innervate.papers.words import percent
from innervate.plot import style
from innervate.trace.streams import stream

TITLE = "1.1: the gateway dies"
CAPTION = (
    "30 nodes; the gateway is switched off at some moment of a discovery period. Everyone sends "
    "one message to the gateway (a: whoever it is) and one to another node (b) every 10 s; 'many': "
    "every 2 s. c: until the last node has the new gateway's table. Standbys wait for requests "
    "(guard_s = 0); what they do if nothing is said, to ask the gateway, takes about a second."
)
DIES_S = 22.0  # at the earliest; up to a discovery period later
PERIOD_S = 10
AFTER_S = 60
BIN_S = 2
BEFORE = 5  # bins
WAITS: Options = (("guard_s", 0),)  # for requests that stay away, as planned; it asks nobody
SOONEST = 30.0  # seconds until all have tables of the new gateway, at most


class Setting(NamedTuple):
    """Who could take over, who dies, and how much is sent."""

    name: str
    standbys: tuple[int, ...]
    dead: tuple[int, ...]
    # everyone sends a message to the gateway and one to another node so often; 0 never
    every_s: int


ALONE = Setting("no standby", (), (GATEWAY,), 10)
SILENT = Setting("one standby, no messages", (1,), (GATEWAY,), 0)
ONE = Setting("one standby", (1,), (GATEWAY,), 10)
SECOND = Setting("two, the first dies too", (1, 2), (GATEWAY, 1), 10)
BUSY = Setting("one standby, many messages", (1,), (GATEWAY,), 2)
SETTINGS = (ALONE, ONE, SECOND, SILENT, BUSY)


def point(setting: Setting, quick: bool) -> Point:
    """Networks with a setting's standbys that run until the table after next."""
    more: Options = (("standby", list(setting.standbys)),) if setting.standbys else ()
    testbed = MeshTestbed(protocol=WAITS, duration_s=DIES_S + PERIOD_S + AFTER_S + 3, more=more)
    what = f"gateway dies, {setting.name}, every {setting.every_s} s"
    return testbed.point(what, beds.seeds(quick), measure, setting)


def points(quick: bool) -> list[Point]:
    """A point for each setting of standbys."""
    return [point(setting, quick) for setting in SETTINGS]


def measure(of: MeshTestbed, setting: Setting, seed: int) -> dict[str, Any]:
    """Takeover; delivery to the gateway and among others, by the time since the death."""
    plan = of.plan(seed)
    dies_us = round(DIES_S * 1e6) + stream(seed, "papers/death").draw(PERIOD_S * 1_000_000)
    beds.kill(plan, setting.dead, dies_us)
    _send(plan, setting, dies_us)
    # Unchecked: a second delivery shall be counted, not end the figure.
    result = simulate(plan, checks=False)
    found = messages(result)
    place = (found.offered_us - dies_us) // (BIN_S * 1_000_000) + BEFORE
    bins = BEFORE + AFTER_S // BIN_S
    came = found.state == DELIVERED
    counts = [
        [np.bincount(place[which], minlength=bins).tolist() for which in (mine & came, mine)]
        for mine in (found.flow == 0, found.flow == 1)
    ]
    summary = summarize(result)
    led = [one["at_s"] - dies_us / 1e6 for one in summary["gateways"]]
    return {
        "bins": counts,
        **{name: summary[name] for name in ("takeover_s", "duplicates")},
        "led_s": max(led) if max(led) > 0 else None,
        "both": _at_both(result),
    }


def _at_both(result: Any) -> int:
    """Messages that two nodes were given: the old gateway and the new one."""
    rows = result.delivered[result.delivered["kind"] == DATA]
    packets = np.unique([rows[name] for name in ("origin", "seq", "node")], axis=1)
    return len(packets[0]) - len(np.unique(packets[:2], axis=1)[0])


def _send(plan: Any, setting: Setting, dies_us: int) -> None:
    """Messages of everyone at drawn moments: flow 0 to the gateway, flow 1 among others."""
    draw = stream(plan.seed, "papers/senders")
    others = [node for node in range(plan.nodes) if node not in setting.dead]
    every_us = setting.every_s * 1_000_000
    first, last = dies_us - BEFORE * BIN_S * 1_000_000, dies_us + AFTER_S * 1_000_000
    for since in range(first, last, every_us) if every_us else ():
        for node in others:
            to = [one for one in others if one != node][draw.draw(len(others) - 1)]
            for flow, dest in enumerate((MONITOR, to)):
                at = since + draw.draw(every_us)
                plan.offers.append(Offer(at, node, dest, END_TO_END, beds.BYTES, flow))
    plan.offers.sort(key=lambda offer: offer.at_us)


def takeovers(got: Measured, setting: Setting) -> list[float]:
    """Seconds from the death until the last node has a table of the new gateway, or infinite."""
    found = got.floats(point(setting, got.quick), "takeover_s")
    return sorted(np.nan_to_num(found, nan=np.inf).tolist())


def _shares(got: Measured, setting: Setting, flow: int) -> tuple[Any, Any]:
    """(seconds since the death, share delivered) of every bin."""
    bins = got[point(setting, got.quick)]["bins"]
    came, sent = np.sum([one[flow] for one in bins], axis=0)
    return (np.arange(len(sent)) - BEFORE + 0.5) * BIN_S, came / np.maximum(sent, 1)


def draw(got: Measured) -> Figure:
    """Delivery over the time since the death; times until all have tables of the new gateway."""
    figure, axes = style.panels(style.WIDE_IN, 2.8, 1, 3, width_ratios=(1.2, 1.2, 1))
    for flow, title in enumerate(("a  to the gateway", "b  among others")):
        ax = axes[flow]
        for i, setting in enumerate((ALONE, ONE, SECOND, BUSY)):
            x, y = _shares(got, setting, flow)
            ax.plot(x, 100 * y, markevery=(i, 5), label=setting.name, **style.look(i))
        ax.axvline(0, color=style.INK, lw=0.8)
        ax.set(ylim=(-4, 104), xlabel="offered so long after the death (s)", title=title)
    axes[0].set_ylabel("delivered (%)")
    axes[1].set_yticklabels([])
    _times(axes[2], got)
    drawing.legend(figure, (axes[2], axes[0]), ncols=3)
    return figure


def _times(ax: Axes, got: Measured) -> None:
    for i, setting in ((1, ONE), (2, SECOND), (4, SILENT)):
        drawing.cumulated(ax, takeovers(got, setting), color=style.SERIES[i],
                          ls=style.DASHES[i % 4], label=setting.name)  # fmt: skip
    ax.axvline(SOONEST, color=style.INK, lw=0.8, ls=":", label="asked for")
    ax.set(xlim=(14, 44), ylim=(0, 104), title="c  tables of the new gateway",
           xlabel="last of them after the death (s)", ylabel="networks (%)")  # fmt: skip


def judge(got: Measured) -> Claims:
    """The document's single gateway; ours."""
    gone, after = (_shares(got, ALONE, flow)[1][BEFORE:] for flow in range(2))
    networks = beds.seeds(got.quick)
    yield ours(
        "1.1",
        "the network outlives the gateway that has computed its tables (0.9 of the messages to "
        "it); the document says nothing of that",
        f"no standby, {AFTER_S} s after its death: {percent(gone.mean())} of the messages to "
        f"the gateway and {percent(after.mean(), 1)} of those among others are delivered; "
        f"{networks} networks",
        verdict(gone.mean() > 0.9),
        "tables in place keep forwarding; what is for the gateway has nobody else to go to",
    )
    for setting in (SILENT, ONE, SECOND):
        yield _taken(got, setting)
    yield _busy(got)
    yield _twice(got)


def _twice(got: Measured) -> Claim:
    runs = [got[point(setting, got.quick)] for setting in SETTINGS]
    twice, both = (sum(sum(one[name]) for one in runs) for name in ("duplicates", "both"))
    return beyond(
        "nothing is delivered twice to a node, or both to the old gateway and to the new one",
        f"{twice} messages twice to a node and {both} to both, in "
        f"{sum(len(one['both']) for one in runs)} runs",
        verdict(not twice and not both),
        ""
        if not twice and not both
        else "an old gateway that dies with its ack unsent has had "
        "the message, and its sender sends it to the new one",
    )


def _taken(got: Measured, setting: Setting) -> Claim:
    times = takeovers(got, setting)
    late = _shares(got, setting, 0)[1][-5:].mean()
    sent = f"; of the last messages to the gateway {percent(late, 1)} come" if late else ""
    most = SOONEST + 5 * (setting is SECOND)
    within = sum(time <= most for time in times)
    most_s = f"at most {times[-1]:.1f} s" if np.isfinite(times[-1]) else "in some never"
    waits = got.floats(point(setting, got.quick), "led_s")
    return beyond(
        f"{setting.name}: tables of the new gateway within {most:g} s of the gateway's death",
        f"{within} of {len(times)} networks; {most_s}{sent}",
        verdict(within == len(times)),
        f"{np.nanmean(waits):.1f} s of it in the mean the standby waits for requests, until it "
        "leads",
    )


def _busy(got: Measured) -> Claim:
    x, share = _shares(got, BUSY, 1)
    before, during = share[x < 0].mean(), share[x > 0].mean()
    times = takeovers(got, BUSY)
    return beyond(
        "who looks for a dead gateway does not disturb the others, however many do (0.98)",
        f"everyone sends to it every {BUSY.every_s} s: of messages among others "
        f"{percent(before, 1)} come before its death and {percent(during, 1)} after it; tables of "
        f"the standby are complete in {sum(np.isfinite(times))} of {len(times)} networks",
        verdict(during > 0.98),
        "" if during > 0.98 else "not known why",
    )
