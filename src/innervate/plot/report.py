"""A run's report: one HTML file that needs nothing else, for a browser, a phone or paper."""

from collections.abc import Iterable, Mapping
from html import escape
from typing import Any

from innervate import scenario as scenarios
from innervate.network import networks
from innervate.plot.page import details, element, page, section, table


def render(run: Any) -> str:
    """The report of a run (its scenario, result, summary and provenance) as HTML."""
    summary = run.summary
    body = networks()[summary["kind"]].report(run.result, summary)
    parts = (body, _numbers(summary), _again(run))
    return page(f"{summary['name']} · innervate", "\n".join(parts))


def _numbers(summary: Mapping[str, Any]) -> str:
    """The whole summary, one line a key."""
    rows = [(escape(key), escape(_value(value))) for key, value in flatten(summary)]
    body = table(("key", "value"), rows, "summary")
    return section("All numbers", details("The summary, as in summary.json", body))


def flatten(value: Any, key: str = "") -> Iterable[tuple[str, Any]]:
    """(dotted key, plain value) of everything inside."""
    if isinstance(value, Mapping) and value:
        for name, inner in value.items():
            yield from flatten(inner, f"{key}.{name}" if key else str(name))
    elif isinstance(value, list) and value and isinstance(value[0], Mapping | list):
        for i, inner in enumerate(value):
            yield from flatten(inner, f"{key}.{i}")
    else:
        yield key, value


def _value(value: Any) -> str:
    if value is None:
        return "never"
    if value == {}:
        return "none"
    if isinstance(value, list):
        shown = ", ".join(_value(item) for item in value[:64])
        return (shown + (f" ... ({len(value)} in all)" if len(value) > 64 else "")) or "none"
    if isinstance(value, float):
        return f"{value:.6g}"
    return str(value)


def _again(run: Any) -> str:
    """How to get the same run again, and from what it came."""
    text = scenarios.dump(run.scenario)
    mark = run.summary["fingerprint"]
    lines = [
        element("p", "In the folder of this report, or with the scenario below saved to a file:"),
        element("pre", "innervate run scenario.toml --out again", "command"),
        element("p", f"It gives the same run, event by event: fingerprint {mark}."),
    ]
    rows = [(escape(key), escape(_value(value))) for key, value in flatten(run.provenance)]
    if len(text) > 40_000:
        text = text[:40_000] + "\n# ... the rest is in scenario.toml\n"
    return section(
        "Run it again",
        "".join(lines)
        + details("The scenario, as resolved", element("pre", text))
        + details("Versions", table(("what", "value"), rows, "summary")),
    )
