"""The timeline of a radio run as SVG: who sends when, and what each station hears of it.

One lane a station, as in Fig. 1 of the paper: boxes for frames, below them CD and VOC as that
station hears them, grey where its radio cannot listen. With many stations boxes alone.
"""

from innervate.networks.radio.plot.scene import DONE, FAILED, NOTICED, Box, Note, Scene
from innervate.networks.radio.plot.words import FrameWords
from innervate.plot import svg
from innervate.plot.charts import LETTER, ticks

WIDTH = 1000.0
LEFT, RIGHT, TOP = 96.0, 16.0, 38.0
DETAILED_MAX = 16  # stations whose CD and VOC are shown
COMPACT_PX = 900.0  # height of all lanes together where they are many
NOTES_PX, BOX_PX, WAVE_PX, STEP_PX, GAP_PX = 11.0, 20.0, 7.0, 11.0, 9.0
TIPS_MAX = 600
LEAST_PX = 1.3
CROSS_PX = 3.0
ROW_PX = 22.0


def draw(shown: Scene) -> svg.Drawing:
    """The drawing of a scene."""
    return _Timeline(shown).drawing


class _Timeline:
    """Scales, lanes and legend of one drawing."""

    def __init__(self, shown: Scene) -> None:
        self.shown = shown
        self.detailed = len(shown.stations) <= DETAILED_MAX
        self.lane = _lane_px(len(shown.stations), self.detailed)
        self.lanes = {station: i for i, station in enumerate(shown.stations)}
        self.bottom = TOP + self.lane * len(shown.stations)
        entries = self._entries()
        height = self.bottom + 44 + ROW_PX * (1 + entries[-1][1] if entries else 0)
        self.drawing = svg.Drawing(WIDTH, height, self._label())
        self._axes()
        for station in shown.stations:
            self._lane(station)
        self._boxes()
        for note in filter(self._is_shown, shown.notes):
            self._note(note)
        for at, row, kind, words in entries:
            y = self.bottom + 54 + ROW_PX * row
            _sample(self.drawing, (at, y), kind)
            self.drawing.text((at + 28, y + 4), words, "small")

    def _label(self) -> str:
        low, high, _ = self.shown.window
        return (
            f"Timeline of {len(self.shown.stations)} stations, {low / 1e3:.3f} to "
            f"{high / 1e3:.3f} ms: {len(self.shown.boxes)} transmissions"
        )

    def across(self, at_us: float) -> float:
        """Where a moment lies across the drawing, clamped to the window shown."""
        low, high, _ = self.shown.window
        share = (min(max(at_us, low), high) - low) / (high - low)
        return LEFT + (WIDTH - LEFT - RIGHT) * share

    def top(self, station: int) -> float:
        """Upper edge of a station's lane."""
        return TOP + self.lane * self.lanes[station]

    def floor(self, station: int) -> float:
        """What the boxes of a station stand on."""
        if self.detailed:
            return self.top(station) + NOTES_PX + BOX_PX
        return self.top(station) + 0.9 * self.lane

    @property
    def box_px(self) -> float:
        """Height of the highest boxes."""
        return BOX_PX if self.detailed else 0.8 * self.lane

    def _axes(self) -> None:
        drawing, (low, high, origin) = self.drawing, self.shown.window
        slot = self.shown.slot_us
        for at in ticks(low / 1e3, high / 1e3, 10):
            x = self.across(1e3 * at)
            drawing.line((x, TOP), (x, self.bottom + 4), "grid")
            drawing.text((x, self.bottom + 17), f"{at:g}", "small", "middle")
        drawing.line((LEFT, self.bottom), (WIDTH - RIGHT, self.bottom), "axis")
        drawing.text((WIDTH - RIGHT, self.bottom + 33), "ms of the run", "small", "end")
        for at in ticks((low - origin) / slot, (high - origin) / slot, 10):
            x = self.across(origin + at * slot)
            drawing.line((x, TOP - 5), (x, TOP), "axis")
            drawing.text((x, TOP - 9), f"{at:g}", "small", "middle")
        drawing.line((LEFT, TOP), (WIDTH - RIGHT, TOP), "axis")
        drawing.text((LEFT - 12, TOP - 9), "slots", "small", "end")

    def _lane(self, station: int) -> None:
        drawing, heard = self.drawing, self.shown.heard[station]
        top, floor = self.top(station), self.floor(station)
        every = max(1, -int(-13 // self.lane))
        if self.lanes[station] % every == 0:
            name = f"station {station}" if self.lane >= 12 else str(station)
            kind = "strong" if self.detailed else "small"
            drawing.text((LEFT - 12, floor - min(self.box_px / 2, 8) + 3), name, kind, "end")
        if self.lane >= 8 or self.lanes[station] % every == 0:
            drawing.line((LEFT, floor), (WIDTH - RIGHT, floor), "grid")
        reach = NOTES_PX + BOX_PX + 2 * STEP_PX + 2 if self.detailed else 0.9 * self.lane
        above = NOTES_PX if self.detailed else 0.1 * self.lane
        for kind, spans in (("deaf", heard.deaf), ("off", heard.off)):
            parts = [(self.across(a), self.across(b)) for a, b in spans.tolist()]
            area = "".join(_box(a, top + above, b - a, reach - above) for a, b in parts)
            drawing.path(area, kind)
            if kind == "off" and self.lane >= 12:
                for a, b in parts:
                    if b - a > 30:
                        drawing.text(((a + b) / 2, floor - 5), "off", "small", "middle")
        if self.detailed:
            self._waves(station)

    def _waves(self, station: int) -> None:
        """CD and VOC: high where 1, a line where 0, nothing where the radio cannot listen."""
        heard = self.shown.heard[station]
        shut = sorted([*heard.deaf.tolist(), *heard.off.tolist()])
        for i, (name, spans) in enumerate((("CD", heard.cd), ("VOC", heard.voc))):
            base = self.floor(station) + STEP_PX * (i + 1)
            self.drawing.text((LEFT - 12, base), name, "small", "end")
            at, quiet = self.shown.window.from_us, []
            for low, high in shut:
                quiet.append((at, low))
                at = max(at, high)
            quiet.append((at, self.shown.window.to_us))
            line = "".join(
                f"M{svg.number(self.across(a))},{svg.number(base)}H{svg.number(self.across(b))}"
                for a, b in quiet
                if b > a
            )
            self.drawing.path(line, "axis")
            ones = [(self.across(a), self.across(b)) for a, b in spans.tolist()]
            area = "".join(_box(a, base - WAVE_PX, max(b - a, 0.6), WAVE_PX) for a, b in ones)
            self.drawing.path(area, "ones")

    def _boxes(self) -> None:
        few = len(self.shown.boxes) <= TIPS_MAX
        together: dict[str, list[str]] = {}
        struck: list[str] = []
        for box in self.shown.boxes:
            if box.end_us <= self.shown.window.from_us or box.start_us >= self.shown.window.to_us:
                continue
            left, right = self.across(box.start_us), self.across(box.end_us)
            wide, high = max(right - left, LEAST_PX), self.box_px * box.words.height
            floor = self.floor(box.station)
            shape = _box(left, floor - high, wide, high)
            if few:
                self.drawing.path(shape, f"frame {box.words.kind}", box.tip)
            else:
                together.setdefault(box.words.kind, []).append(shape)
            label = self._box_label(box, wide)
            middle = floor - high / 2
            if box.collided:
                size = min(CROSS_PX, wide / 2, high / 2)
                far = left + wide - CROSS_PX - 3 if label else left + wide / 2
                # On the smallest boxes an outline would leave nothing else to see.
                outline = shape if self.lane >= 12 else ""
                struck.append(outline + svg.cross(far, middle, size))
            if label:
                shift = -CROSS_PX - 1 if box.collided else 0.0
                self.drawing.text((left + wide / 2 + shift, middle + 4), label, "", "middle")
        for kind, shapes in together.items():
            self.drawing.path("".join(shapes), f"frame {kind}")
        self.drawing.path("".join(struck), "struck")

    def _box_label(self, box: Box, wide: float) -> str:
        """The longest label that fits."""
        high = self.box_px * box.words.height
        room = wide - 3 - (2 * CROSS_PX + 4 if box.collided else 0)
        fits = (label for label in box.labels if LETTER * len(label) + 1 <= room)
        return next(fits, "") if high >= 12 else ""

    def _is_shown(self, note: Note) -> bool:
        """Marks have a strip of their own only in detailed lanes."""
        return self.detailed or (self.lane >= NOTES_PX and note.kind != NOTICED)

    def _note(self, note: Note) -> None:
        x = self.across(note.at_us) + (0 if self.detailed else 7)
        y = self.top(note.station) + (NOTES_PX / 2 if self.detailed else self.lane / 2)
        _mark(self.drawing, (x, y), note.kind, note.tip)

    def _entries(self) -> list[tuple[float, int, str | FrameWords, str]]:
        """The legend: (x, row, what, words), from left to right and down."""
        shown = self.shown
        found: list[tuple[str | FrameWords, str]] = [(f, f.meaning) for f in shown.frames]
        if any(box.collided for box in shown.boxes):
            found.append(("struck", "collided"))
        if any(len(heard.deaf) for heard in shown.heard.values()):
            found.append(("deaf", "its radio cannot listen"))
        if any(len(heard.off) for heard in shown.heard.values()):
            found.append(("off", shown.off))
        if self.detailed:
            found.append(("ones", "CD: hears somebody; VOC: hears exactly one"))
        kinds = {note.kind for note in shown.notes if self._is_shown(note)}
        if kinds:
            words = {NOTICED: "collision noticed", DONE: "knows it was delivered",
                     FAILED: "not confirmed, sends again"}  # fmt: skip
            found += [(kind, words[kind]) for kind in words if kind in kinds]
        if any(len(box.labels) > 2 for box in shown.boxes) and self.detailed:
            found.append(("", "D3: data in place or turn 3"))
        entries, at, row = [], LEFT, 0
        for what, text in found:
            long = 28 + 6.4 * len(text) + 22
            if at + long > WIDTH:
                at, row = LEFT, row + 1
            entries.append((at if what else at - 28, row, what, text))
            at += long
        return entries


def _lane_px(count: int, detailed: bool) -> float:
    if detailed:
        return NOTES_PX + BOX_PX + 2 * STEP_PX + GAP_PX
    return min(24.0, max(5.0, COMPACT_PX / max(count, 1)))


def _box(left: float, top: float, wide: float, high: float) -> str:
    """Path data of a rectangle."""
    x, y, w, h = (svg.number(value) for value in (left, top, wide, high))
    return f"M{x},{y}h{w}v{h}h{svg.number(-wide)}z"


def _mark(drawing: svg.Drawing, at: svg.Point, kind: str, tip: str = "") -> None:
    """The sign of a note."""
    x, y = at
    if kind == NOTICED:
        drawing.path(svg.polygon(x, y, [(0, -4), (4.5, 4), (-4.5, 4)]), "warn", tip)
    elif kind == DONE:
        drawing.path(svg.polyline([(x - 4, y), (x - 1, y + 3), (x + 4, y - 4)]), "done", tip)
    elif kind == FAILED:
        drawing.path(svg.polygon(x, y, [(0, -4), (4, 0), (0, 4), (-4, 0)]), "lack", tip)


def _sample(drawing: svg.Drawing, at: svg.Point, what: str | FrameWords) -> None:
    """A sample for the legend."""
    x, y = at
    if isinstance(what, FrameWords):
        high = 14 * what.height
        drawing.path(_box(x, y + 7 - high, 20, high), f"frame {what.kind}")
        if what.height >= 0.7:
            drawing.text((x + 10, y + 11 - high / 2), what.letter, "", "middle")
    elif what == "struck":
        drawing.path(_box(x, y - 7, 20, 14) + svg.cross(x + 10, y, CROSS_PX), "struck")
    elif what in ("deaf", "off"):
        drawing.path(_box(x, y - 7, 20, 14), what)
    elif what == "ones":
        line = f"M{svg.number(x)},{svg.number(y + 4)}h20"
        drawing.path(line, "axis")
        drawing.path(_box(x + 6, y + 4 - WAVE_PX, 9, WAVE_PX), what)
    elif what:
        _mark(drawing, (x + 10, y), what)
