"""Which moments of a run are worth a picture, and the pictures."""

from bisect import bisect_right
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from innervate.analysis.headline import verb
from innervate.kernel.words import number_of
from innervate.networks.skin.analysis import touch
from innervate.networks.skin.analysis.frames import lost_at_start
from innervate.networks.skin.plot import map as skinmap
from innervate.networks.skin.plot import words as skin_words
from innervate.networks.skin.plot.history import History
from innervate.networks.skin.plot.sheet import Sheet
from innervate.plot import charts, words
from innervate.scenario.actions.cables import ACTIONS
from innervate.scenario.cables import Fault

WINDOW_PERIODS = 1.25
ZOOMS_MAX = 6
OUTAGE_US = 1000
MARKS_MAX = 8


@dataclass(frozen=True, slots=True)
class Incident:
    """An event of the scenario with what came of it."""

    fault: Fault  # what happened
    recovery: Mapping[str, Any]  # its entry in the summary
    until_us: int  # when the next later event came, or the run ended

    @property
    def at_us(self) -> int:
        """When the failure came, us."""
        return round(1e6 * float(self.recovery["at_s"]))

    @property
    def routed_us(self) -> int:
        """When all cells that cables reach had a route again; before `until_us` if never."""
        routed_ms = self.recovery["others_ms"]
        if routed_ms is None:
            return max(self.at_us, self.until_us - 1)
        return self.at_us + round(1e3 * float(routed_ms))


class Digest:
    """A run of a skin, as pictures are made from it."""

    def __init__(self, result: Any, summary: Mapping[str, Any]) -> None:
        self.result = result
        self.plan = result.plan
        self.graph = result.plan.graph
        self.summary = summary
        self.history = History(result)
        self.incidents = self._incidents()

    def _incidents(self) -> list[Incident]:
        recoveries = self.summary["recoveries"]
        starts = [round(1e6 * recovery["at_s"]) for recovery in recoveries]
        later = [*starts, self.result.ended_us]
        ends = [later[bisect_right(starts, start)] for start in starts]
        faults = self.plan.faults[: len(recoveries)]
        return [Incident(*three) for three in zip(faults, recoveries, ends, strict=True)]

    @cached_property
    def sheet(self) -> Sheet:
        """Where everything lies on maps of routes."""
        return Sheet(self.graph)

    @cached_property
    def bare_sheet(self) -> Sheet:
        """Where the cells lie on pictures of touch."""
        return Sheet(self.graph, margin=18.0)

    @cached_property
    def hero(self) -> Incident | None:
        """The event that cut off most cells; None if none did."""
        hurt = [i for i in self.incidents if i.recovery["cut_cells"]]
        return max(hurt, key=lambda i: i.recovery["cut_cells"], default=None)

    def headline(self, incident: Incident) -> str:
        """An event and what came of it."""
        who = number_of(incident.recovery["without_way"], "cell")
        still = f"{who} still had no way to the PC {self._then(incident)}"
        return skin_words.headline(self.graph, incident.fault, incident.recovery, still)

    def _then(self, incident: Incident) -> str:
        last = incident.until_us >= self.result.ended_us
        return "at the end" if last else "when the next event came"

    def maps(self) -> list[charts.Panel]:
        """Routes before, during and after the worst event; without one, at the end."""
        hero = self.hero
        if hero is None:
            return [self._map(self.result.ended_us, "At the end")]
        (before, time_us), *later = self.moments()
        return [
            self._map(time_us, before),
            *(self._map(time_us, head, self._lacking(hero, time_us)) for head, time_us in later),
        ]

    def moments(self) -> list[tuple[str, int]]:
        """(name, time in us) of the moments of the worst event; none if no event was bad."""
        hero = self.hero
        if hero is None:
            return []
        worst_us, most = self.history.lacking_max(hero.at_us, hero.routed_us)
        half_us, few = self.history.first_below(worst_us, hero.routed_us, most / 2)
        left = self.history.lacking_at(hero.routed_us)
        return [
            ("Before", hero.at_us - 1),
            ("The worst moment", worst_us),
            *([("On the way back", half_us)] if few < most else []),
            ("Afterwards" if left == 0 else f"Still so {self._then(hero)}", hero.routed_us),
        ]

    def _lacking(self, hero: Incident, time_us: int) -> str:
        when = f"{words.ms_words((time_us - hero.at_us) / 1e3)} after the event"
        return f"{when}: {self._crossed(time_us)}"

    def _crossed(self, time_us: int) -> str:
        """The cells that a map crosses out, in words."""
        count, gone = self.history.lacking_at(time_us), self.history.cut_off_at(time_us)
        off = len(self.history.at(time_us).dead)
        who = number_of(count, "cell") if count else "no cell"
        parts = [f"{who} without a way"]
        if gone:
            them, it = ("all cut off", "cut off") if gone == count else (f"{gone:,} cut off", "")
            parts.append(it if count == 1 else them)
        if off:
            parts.append(f"{off:,} switched off")
        return ", ".join(parts)

    def _map(self, time_us: int, head: str, text: str = "") -> charts.Panel:
        moment = self.history.at(time_us)
        drawing = skinmap.route_map(self.sheet, moment, f"Routes of the skin: {head} {text}")
        return charts.Panel(drawing, head, text)

    def zooms(self) -> list[charts.Steps]:
        """Cells without a route round each moment whose events cost some of them theirs."""
        moments = {incident.at_us: incident for incident in self.incidents}
        hurt = [i for i in moments.values() if self._is_outage(i)]
        return [self._zoom(incident) for incident in hurt[:ZOOMS_MAX]]

    def _is_outage(self, incident: Incident) -> bool:
        lasted_us = incident.routed_us - incident.at_us
        most = self.history.lacking_max(incident.at_us, incident.until_us - 1)[1]
        return most > 0 and lasted_us >= OUTAGE_US

    def _zoom(self, incident: Incident) -> charts.Steps:
        recovery, start = incident.recovery, incident.at_us
        marks = [charts.Mark(0.0, ACTIONS[incident.fault.action])]
        reach = (incident.routed_us - start) / 1e3
        rest = "all others routed" if recovery["cut_off_total"] else "all routed"
        for key, name in (("detected_ms", "noticed"), ("others_ms", rest)):
            if recovery[key] is not None and recovery[key] > 0:
                reach = max(reach, recovery[key])
                marks.append(charts.Mark(recovery[key], f"{name} {words.ms_words(recovery[key])}"))
        reach = max(reach, 1.0)
        times, cells = self.history.steps()
        inside = self.history.lacking_max(start, start + round(1e3 * reach))[1]
        x = charts.Axis(-0.12 * reach, 1.6 * reach, "ms after the event")
        y = charts.Axis(0.0, 1.08 * max(inside, 1))
        what = skin_words.fault_words(self.graph, incident.fault)
        text = f"{what[0].upper()}{what[1:]} at {start / 1e6:.3f} s."
        head = "Cells without a way to the PC"
        at, label = (times - start) / 1e3, self.headline(incident)
        return charts.Steps(at, cells, x, y, head, text, marks, label=label)

    def overview(self) -> list[charts.Steps]:
        """The whole run: cells without a route, samples received."""
        times, cells = self.history.steps()
        end_s = max(self.result.ended_us, 1) / 1e6
        x = charts.Axis(0.0, end_s, "seconds")
        events = ((i.at_us, ACTIONS[i.fault.action]) for i in self.incidents)
        marks = charts.marked(events, MARKS_MAX)
        most = 1.08 * max(int(cells.max(initial=0)), 1)
        y = charts.Axis(0.0, most)
        head = "Cells without a way to the PC, whole run"
        panels = [charts.Steps(times / 1e6, cells, x, y, head, "", marks, 165.0)]
        received = self._received(x, marks)
        return panels + ([received] if received else [])

    def _received(self, x: charts.Axis, marks: list[charts.Mark]) -> charts.Steps | None:
        """Samples received in each sample period, as a share of the cells."""
        period, times = self.plan.data_period_us, self.result.deliveries["time"]
        if not period or len(times) == 0:
            return None
        width = max(period, self.result.ended_us // 400)
        bins = max(1, self.result.ended_us // width)
        count = np.bincount(np.minimum(times // width, bins), minlength=bins + 1)[:bins]
        share = 100.0 * count / (self.graph.cells * width / period)
        y = charts.Axis(0.0, 1.08 * max(100.0, float(share.max())))
        at = np.arange(bins) * width / 1e6
        head = "Tactile samples received, whole run"
        text = f"In % of what all cells measure, in steps of {words.ms_words(width / 1e3)}."
        return charts.Steps(at, share, x, y, head, text, marks, 165.0)

    def images(self) -> list[charts.Panel]:
        """What the PC received before, during and after the worst event."""
        period = self.plan.data_period_us
        if not period or len(self.result.deliveries) == 0:
            return []
        window_us = round(WINDOW_PERIODS * period)
        hero = self.hero
        if hero is None:
            return [self.image(self.result.ended_us, window_us, "At the end")]
        after_us = min(hero.routed_us + window_us + 5000, hero.until_us, self.result.ended_us)
        return [
            self.image(hero.at_us, window_us, "Before"),
            self.image(hero.routed_us, window_us, "During the recovery"),
            self.image(after_us, window_us, "After"),
        ]

    def image(self, time_us: int, window_us: int, head: str) -> charts.Panel:
        """What had come in a window before a time."""
        image = touch.received_image(self.result, time_us / 1e6, window_us / 1e6)
        force_n = np.where(image.known, image.force_mn / 1e3, np.nan)
        missing = int(np.count_nonzero(~image.known))
        text = "all samples came"
        if missing:
            text = f"nothing from {missing:,} of {number_of(self.graph.cells, 'cell')}"
        pressed = self.plan.touch
        most = pressed.force_mn / 1e3 if pressed is not None else 1.0
        label = f"Touch as the PC received it: {head}, {text}"
        drawing = skinmap.value_map(self.bare_sheet, force_n, most, label, " N")
        if pressed is not None and len(pressed.x_um):
            at = min(max(0, time_us - window_us // 2) // pressed.step_us, len(pressed.x_um) - 1)
            place = (pressed.x_um[at] / 1e3, pressed.y_um[at] / 1e3)
            skinmap.touch_ring(drawing, self.bare_sheet, *place, pressed.radius_um / 1e3)
        return charts.Panel(drawing, head, text)

    def loads(self) -> charts.Bars | None:
        """Cells that each interface port serves at the end."""
        loads = self.summary["port_loads"]
        if not loads:
            return None
        alike = skinmap.shows_depth(self.graph.interfaces)  # ports have no colours of their own
        bars = []
        for i, load in enumerate(loads):
            kind = "bar" if alike else f"p{i}"
            bars.append(charts.Bar(f"port {i}", load, number_of(load, "cell"), kind))
        even = sum(loads) / len(loads) if len(loads) > 1 else None
        factor = self.summary["balance_factor"]
        text = f"Balance factor {factor:.3f}; 1 is even." if factor is not None else ""
        label = "Cells served by each interface port at the end"
        return charts.Bars(bars, "Cells behind each interface port", text, even, label)

    def losses(self) -> charts.Bars | None:
        """Bars of how many samples were lost for which reason; None if none was."""
        data = self.summary["data"]
        lost = {k: n for k, n in data.get("lost_by", {}).items() if n}
        if not lost:
            return None
        bars = [
            charts.Bar(skin_words.LOST.get(reason, reason), count, f"{count:,}")
            for reason, count in sorted(lost.items(), key=lambda item: -item[1])
        ]
        all_lost = data["lost"]
        total = f"{all_lost:,} of {data['sent']:,} samples {verb(all_lost, 'was')} lost"
        if early := skin_words.early_words(all_lost, lost_at_start(self.result)):
            total += f", {early}"
        return charts.Bars(bars, "Where samples were lost", f"{total}.",
                           label="Lost samples by reason")  # fmt: skip
