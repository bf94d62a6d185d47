"""A run in a cell of a notebook: the top of its report and a picture."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from innervate.analysis.mesh_alarms import all_crossings
from innervate.plot import mesh_report, radio_report, radio_slotted_report, skin_report, theme
from innervate.plot.mesh_sheet import Sheet
from innervate.plot.page import PARTS
from innervate.plot.story import Story

NAME = "innervate-run"


def render(result: Any, summary: Mapping[str, Any]) -> str:
    """A run as a piece of HTML that neither takes the notebook's styles nor changes them."""
    inside = _SHOWN[summary.get("level", summary["kind"])](result, summary)
    style = (theme.drawing_style() + PARTS).replace(":root", "&")
    frame = (
        "&{padding:12px 16px;border-radius:8px;background:var(--ground);color:var(--ink);"
        "font:15px/1.45 system-ui,sans-serif}"
    )
    return f'<div class="{NAME}"><style>.{NAME}{{{style}{frame}}}</style>\n{inside}</div>'


def _skin(result: Any, summary: Mapping[str, Any]) -> str:
    story = Story(result, summary)
    return skin_report.top(story) + skin_report.maps(story)


def _radio(result: Any, summary: Mapping[str, Any]) -> str:
    return radio_report.top(result, summary) + radio_report.on_air(result)


def _slotted(result: Any, summary: Mapping[str, Any]) -> str:
    return radio_slotted_report.top(result, summary) + radio_slotted_report.charts_of(
        result, summary
    )


def _mesh(result: Any, summary: Mapping[str, Any]) -> str:
    shown = mesh_report.field(result, Sheet(result.plan), all_crossings(result))
    return mesh_report.top(result, summary) + shown


_SHOWN = {"skin": _skin, "radio": _radio, "slotted": _slotted, "mesh": _mesh}
