"""Colours and style sheets of drawings and reports, light and dark.

Categories are the hues of Okabe and Ito, which stay apart for colour-blind readers; every state is
shown by a shape or a word as well.
"""

import tomllib
from pathlib import Path

PORT_COLOURS = 8
SHADES = 8

_HERE = Path(__file__).parent
_PALETTE = tomllib.loads((_HERE / "palette.toml").read_text(encoding="utf-8"))
_SHAPES = "\n" + (_HERE / "shapes.css").read_text(encoding="utf-8")


def _variables(look: str) -> str:
    words = []
    for name, colour in _PALETTE[look].items():
        shades = enumerate(colour) if isinstance(colour, list) else [("", colour)]
        words += [f"--{name}{i}:{shade}" for i, shade in shades]
    return ";".join(words)


def variables() -> str:
    """The colours as CSS variables: light, dark where the reader prefers it, light on paper."""
    light, dark = _variables("light"), _variables("dark")
    return (
        f":root{{color-scheme:light dark;{light}}}\n"
        f"@media (prefers-color-scheme:dark){{:root{{{dark}}}}}\n"
        f"@media print{{:root{{color-scheme:light;{light}}}}}\n"
    )


def drawing_style() -> str:
    """The style sheet of drawings, as a page or a drawing alone needs it."""
    fills = (f".{x}{i}{{fill:var(--{x}{i})}}" for x in "pdh" for i in range(SHADES))
    return variables() + _SHAPES + "".join(fills)


def shade(value: float, most: float) -> int:
    """Which of the shades 0 .. SHADES-1 stands for a value of 0 .. most."""
    if most <= 0:
        return 0
    return min(SHADES - 1, max(0, int(SHADES * value / most)))
