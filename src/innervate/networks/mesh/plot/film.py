"""A crossing of the fence as a film: what was on the air until the monitor knew of it."""

from typing import Any

from innervate.networks.mesh.analysis.alarms import Crossing
from innervate.networks.mesh.analysis.messages import NEVER
from innervate.networks.mesh.analysis.paths import Ground
from innervate.networks.mesh.analysis.way import Hop, copies
from innervate.networks.mesh.plot import map as mesh_map
from innervate.networks.mesh.plot.sheet import Labels, Sheet, shortened
from innervate.networks.mesh.protocol.constants import ACK, ALARM, ALL
from innervate.plot import svg
from innervate.plot.charts import ticks
from innervate.plot.film import Film
from innervate.plot.svg import Point
from innervate.plot.words import figure_words, ms_words

CYCLE_S = 14.0
WINDOW_US = 1_500_000  # a film shows no more
OTHERS_MAX = 700  # transmissions of other packets
FOOT = 66.0  # the time axis below the field
HEAD = 34.0
WAVE_PX = 44.0
FLASH = 0.012  # a transmission is seen for at least this share of the cycle
WAVE = 0.07
STAYS = 0.35  # opacity of what an alarm leaves behind


def film(result: Any, crossing: Crossing, sheet: Sheet) -> Film:
    """The crossing from shortly before it to shortly after the monitor knew."""
    return _Crossing(result, crossing, sheet).drawing


def window(crossing: Crossing, ended_us: int) -> tuple[int, int]:
    """The times that a film shows, us."""
    end = crossing.accepted_us
    if end == NEVER:
        end = min(ended_us, crossing.crossed_us + WINDOW_US)
    long = min(max(end - crossing.crossed_us, 20_000), WINDOW_US)
    return crossing.crossed_us - long // 8, crossing.crossed_us + long + long // 5


class _Crossing:
    """The parts of one film."""

    def __init__(self, result: Any, crossing: Crossing, sheet: Sheet) -> None:
        self.result, self.plan, self.crossing, self.sheet = result, result.plan, crossing, sheet
        self.low, self.high = window(crossing, result.ended_us)
        size = (sheet.width, HEAD + sheet.height + FOOT)
        label = f"Film of the crossing at {crossing.crossed_us / 1e6:.3f} s"
        self.drawing = Film(size, label, (self.low, self.high), CYCLE_S)
        self.sent = copies(result, crossing)
        places = mesh_map.robot_places(self.plan, sheet, crossing.crossed_us)
        self.places = {node: (x, y + HEAD) for node, (x, y) in places.items()}
        self._field(places)
        self._others()
        for hop in self.sent:
            if self.low <= hop.start_us < self.high:
                self._hop(hop)
        self._robot()
        self._told()
        self._axis()

    def _field(self, places: dict[int, Point]) -> None:
        """Draw what stays as it is: the ground, links, nodes and their names."""
        drawing = svg.Drawing(self.sheet.width, self.sheet.height, "")
        names = Labels(self.sheet.width, self.sheet.height)
        on = Ground(self.plan).on_at(self.crossing.crossed_us)
        for hop in self.sent:
            if hop.to < self.plan.nodes:
                names.block_line([places[hop.node], places[hop.to]])
        x, y = self._pin(places)
        names.block((x, y - 8), 8.0)
        field = mesh_map.Field(drawing, self.plan, self.sheet, names, on)
        mesh_map.ground(field)
        mesh_map.nodes(field, places)
        self.drawing.place(drawing, (0.0, HEAD))

    def _others(self) -> None:
        """Everything else on the air: a line to its receiver, or a ring."""
        sent = self.result.sent
        inside = (sent["end"] > self.low) & (sent["time"] < self.high)
        mine = (sent["kind"] == ALARM) | (sent["kind"] == ACK)
        if self.sent:
            first = self.sent[0]
            mine = (sent["kind"] == ACK) | (
                (sent["kind"] == ALARM) & (sent["time"] >= first.start_us)
            )
        for row in sent[inside & ~mine][:OTHERS_MAX]:
            steps = self._flash(int(row["time"]), int(row["end"]))
            node, to = int(row["node"]), int(row["link_dst"])
            if to < self.plan.nodes:
                ends = shortened(self.places[node], self.places[to], self.sheet.dot + 2)
                self.drawing.seen("path", steps, class_="other", d=svg.polyline(ends))
            else:
                x, y = self.places[node]
                self.drawing.seen("circle", steps, class_="other", cx=x, cy=y, r=self.sheet.dot + 7)

    def _flash(self, start: int, end: int) -> list[tuple[float, float]]:
        least = FLASH * (self.high - self.low)
        return [(start, 1.0), (max(end, start + least), 0.0)]

    def _hop(self, hop: Hop) -> None:
        """A transmission of the alarm: an arrow to the next hop, or a wave to all."""
        at = self.places[hop.node]
        if hop.to == ALL or hop.to >= self.plan.nodes:
            until = hop.start_us + WAVE * (self.high - self.low)
            radius = [(hop.start_us, self.sheet.dot + 2), (until, WAVE_PX)]
            before = hop.start_us - 0.001 * (self.high - self.low)
            fading = [(self.low, 0.0), (before, 0.0), (hop.start_us, 1.0), (until, 0.0)]
            self.drawing.grown(radius, fading, class_="wave", cx=at[0], cy=at[1])
            ring = self.sheet.dot + mesh_map.RING_PX + 2
            self.drawing.seen("circle", [(hop.start_us, 1.0)], class_="flooder",
                              cx=at[0], cy=at[1], r=ring)  # fmt: skip
            return
        data = svg.arrow(at, self.places[hop.to], self.sheet.dot + 3)
        start, end = self._flash(hop.start_us, hop.end_us)
        kind = "way" if hop.receivers else "way failed"
        self.drawing.seen("path", [start, (end[0], STAYS)], class_=kind, d=data)

    def _robot(self) -> None:
        """Where the fence was crossed, from then on."""
        self.drawing.seen("path", [(self.crossing.crossed_us, 1.0)], class_="warn",
                          d=mesh_map.pin(self._pin(self.places)))  # fmt: skip

    def _pin(self, places: dict[int, Point]) -> Point:
        """Where the tip of the crossing's pin is: above the robot."""
        x, y = places[self.crossing.robot]
        return x, y - self.sheet.dot - 4

    def _told(self) -> None:
        """Draw two rings about the monitor from the moment on when it knows."""
        if self.crossing.accepted_us == NEVER:
            return
        given = self.result.delivered[self.crossing.row]
        x, y = self.places[int(given["node"])]
        for radius in (14.0, 19.0):
            self.drawing.seen("circle", [(self.crossing.accepted_us, 1.0)], class_="done",
                              cx=x, cy=y, r=radius)  # fmt: skip

    def _phases(self) -> list[tuple[int, str, str]]:
        """(from when, how, what) for the line above the field."""
        crossing, name = self.crossing, self.plan.names[self.crossing.robot]
        found = [(self.low, f"robot {name} is inside the fence", "strong heavy")]
        found.append((crossing.crossed_us, f"robot {name} has left the fence", "alarm heavy"))
        if crossing.raised_us != NEVER:
            who = "the robot" if crossing.raised_by == crossing.robot else (
                f"node {self.plan.names[crossing.raised_by]}, a witness,"
            )  # fmt: skip
            found.append((crossing.raised_us, f"{who} raises the alarm", "alarm heavy"))
        if crossing.accepted_us != NEVER:
            took = ms_words((crossing.accepted_us - crossing.raised_us) / 1e3)
            out = f"{figure_words(crossing.overrun_m, 2)} m out"
            found.append((crossing.accepted_us, f"the monitor knows, {took} later: robot {out}",
                          "strong heavy"))  # fmt: skip
        return found

    def _axis(self) -> None:
        """Time below the field, what happened when, and where the film is."""
        drawing, sheet = self.drawing, self.sheet
        phases = self._phases()
        for i, (at, words, kind) in enumerate(phases):
            over = phases[i + 1][0] if i + 1 < len(phases) else None
            steps = [(float(at), 1.0), *([(float(over), 0.0)] if over is not None else [])]
            drawing.seen("text", steps, words, class_=kind, x=14.0, y=22.0)
        left, right, base = 20.0, sheet.width - 20.0, HEAD + sheet.height + 26
        origin = self.crossing.crossed_us

        def across(time: float) -> float:
            return left + (right - left) * drawing.share(time)

        drawing.line((left, base), (right, base), "axis")
        for ms in ticks((self.low - origin) / 1e3, (self.high - origin) / 1e3, 8):
            x = across(origin + 1e3 * ms)
            drawing.line((x, base), (x, base + 4), "axis")
            drawing.text((x, base + 17), f"{ms:g}", "small", "middle")
        drawing.text((right, base + 34), "ms after the crossing", "small", "end")
        self._moments(across, base)
        drawing.moved("path", [(self.low, (left, 0.0)), (self.high, (right, 0.0))],
                      class_="cursor", d=f"M0,{svg.number(base - 24)}v30")  # fmt: skip

    def _moments(self, across: Any, base: float) -> None:
        """Marks on the time axis, their words where they do not meet."""
        crossing, free = self.crossing, -1.0
        moments = [(crossing.crossed_us, "crossed"), (crossing.raised_us, "raised"),
                   (crossing.accepted_us, "monitor knows")]  # fmt: skip
        for at, words in moments:
            if at == NEVER:
                continue
            x = across(at)
            self.drawing.line((x, base - 8), (x, base), "mark")
            start = max(x, free)
            self.drawing.text((start, base - 12), words, "small", "start")
            free = start + 6.6 * len(words) + 8
