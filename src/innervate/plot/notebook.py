"""A run in a cell of a notebook: the top of its report and a picture."""

from collections.abc import Mapping
from typing import Any

from innervate.network import networks
from innervate.plot import theme
from innervate.plot.page import PARTS

NAME = "innervate-run"


def render(result: Any, summary: Mapping[str, Any]) -> str:
    """A run as a piece of HTML that neither takes the notebook's styles nor changes them."""
    inside = networks()[summary["kind"]].notebook(result, summary)
    style = (theme.drawing_style() + PARTS).replace(":root", "&")
    frame = (
        "&{padding:12px 16px;border-radius:8px;background:var(--ground);color:var(--ink);"
        "font:15px/1.45 system-ui,sans-serif}"
    )
    return f'<div class="{NAME}"><style>.{NAME}{{{style}{frame}}}</style>\n{inside}</div>'
