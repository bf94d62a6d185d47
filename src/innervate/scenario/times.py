"""Times of events: which of them a run still sees."""

from __future__ import annotations

from innervate.scenario.lines import Key
from innervate.scenario.source import Source


def check_end(source: Source, index: int, at_s: float, duration_s: float) -> None:
    """That event `index`, at `at_s` at the latest, happens: a run ends just before `duration_s`.

    Raises:
        ScenarioError: it would not.
    """
    key: Key = ("event", index, "at_s")
    name = f"event.{index}.at_s = {at_s:g}"
    if round(1e6 * at_s) > round(1e6 * duration_s):
        raise source.error(key, f"{name} is outside the run; duration_s is {duration_s:g}")
    if round(1e6 * at_s) == round(1e6 * duration_s):
        message = f"{name} is the end of the run, so it would never happen"
        raise source.error(key, f"{message}; make it earlier, or duration_s longer")
