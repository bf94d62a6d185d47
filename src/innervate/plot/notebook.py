"""A run or a sweep in a cell of a notebook: the top of its report and its pictures."""

from collections.abc import Mapping
from typing import Any

from innervate.network import networks
from innervate.plot import theme
from innervate.plot.page import PARTS

NAME = "innervate-run"


# Themes of notebooks and sites have headings of their own, some by the size of the window.
_FRAME = (
    "&{padding:12px 16px;border-radius:8px;background:var(--ground);color:var(--ink);"
    "font:15px/1.45 system-ui,sans-serif}"
    "h1,h2,h3{color:inherit;font-weight:600;letter-spacing:normal}"
    "h1{font-size:1.4em}h2{font-size:1.15em}h3{font-size:1em}"
)


def render(result: Any, summary: Mapping[str, Any]) -> str:
    """A run as a piece of HTML for a cell."""
    return framed(networks()[summary["kind"]].notebook(result, summary))


def framed(inside: str, style: str = "") -> str:
    """HTML that neither takes the notebook's styles nor changes them; `style` is added to ours."""
    own = (theme.drawing_style() + PARTS + style).replace(":root", "&")
    return f'<div class="{NAME}"><style>.{NAME}{{{own}{_FRAME}}}</style>\n{inside}</div>'
