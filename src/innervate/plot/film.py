"""Drawings that move: SVG with SMIL animations that repeat together, without any script.

Where nothing can move, on paper for example, a film shows its last moment.
"""

from collections.abc import Sequence

from innervate.plot.svg import Drawing, Value, clean, number, opening

Step = tuple[float, float]


class Film(Drawing):
    """A drawing whose parts appear, go and move in a cycle."""

    def __init__(self, size: Step, label: str, window: tuple[float, float], cycle_s: float) -> None:
        super().__init__(*size, label)
        self.low, self.high = window  # the times that it shows; all times given are of their unit
        self.cycle_s = cycle_s  # of the viewer's time

    def share(self, time: float) -> float:
        """Where in the cycle a time is, 0 .. 1."""
        return min(1.0, max(0.0, (time - self.low) / (self.high - self.low)))

    def seen(
        self, tag: str, steps: Sequence[Step], content: str | None = None, **attributes: Value
    ) -> None:
        """An element, as for `add`, whose opacity is that of the last step behind, 0 before.

        Steps are (time, opacity), in order of time.
        """
        inner = self._changes("opacity", [(self.low, 0.0), *steps], "discrete")
        last = steps[-1][1] if steps else 0.0
        self._element(tag, content, inner, {**attributes, "opacity": last})

    def grown(self, steps: Sequence[Step], fading: Sequence[Step], **attributes: Value) -> None:
        """A circle whose radius runs through steps (time, px), and fades as `fading` says."""
        inner = self._changes("r", steps, "linear") + self._changes("opacity", fading, "linear")
        self._element("circle", None, inner, {**attributes, "r": steps[-1][1], "opacity": 0.0})

    def moved(self, tag: str, path: Sequence[tuple[float, Step]], **attributes: Value) -> None:
        """An element that is shifted along a path of (time, (x, y))."""
        times = ";".join(self._time(time) for time, _ in path)
        values = ";".join(f"{number(x)} {number(y)}" for _, (x, y) in path)
        inner = (
            f'<animateTransform attributeName="transform" type="translate" values="{values}" '
            f'keyTimes="{times}" dur="{number(self.cycle_s)}s" repeatCount="indefinite"/>'
        )
        x, y = path[-1][1]
        place = f"translate({number(x)} {number(y)})"
        self._element(tag, None, inner, {**attributes, "transform": place})

    def _changes(self, name: str, steps: Sequence[Step], mode: str) -> str:
        kept: dict[str, float] = {}
        for time, value in steps:
            kept[self._time(time)] = value  # of several at one time the last one counts
        if mode == "linear":
            first, last = next(iter(kept.values())), list(kept.values())[-1]
            kept = {"0": first, **kept} if "0" not in kept else kept
            kept = {**kept, "1": last} if "1" not in kept else kept
        times = ";".join(kept)
        values = ";".join(number(value) for value in kept.values())
        return (
            f'<animate attributeName="{name}" values="{values}" keyTimes="{times}" '
            f'calcMode="{mode}" dur="{number(self.cycle_s)}s" repeatCount="indefinite"/>'
        )

    def _time(self, time: float) -> str:
        return f"{self.share(time):.5f}".rstrip("0").rstrip(".") or "0"

    def _element(
        self, tag: str, content: str | None, inner: str, attributes: dict[str, Value]
    ) -> None:
        text = clean(content) if content is not None else ""
        self._parts.append(f"<{opening(tag, attributes)}>{text}{inner}</{tag}>")
