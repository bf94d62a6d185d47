"""Colours and style sheets of drawings and reports, light and dark.

Categories are the hues of Okabe and Ito, which stay apart for colour-blind readers; every state is
shown by a shape or a word as well.
"""

from __future__ import annotations

from pathlib import Path

PORT_COLOURS = 8
SHADES = 8

_LIGHT = {
    "ground": "#ffffff",
    "panel": "#f6f7f9",
    "ink": "#1c2430",
    "soft": "#5b6675",
    "faint": "#d5dae1",
    "link": "#26303d",
    "alarm": "#c43d00",
    "warn": "#8a5a00",
    "good": "#00734f",
    "accent": "#0063a6",
}
_DARK = {
    "ground": "#12161c",
    "panel": "#1b2129",
    "ink": "#e8ecf1",
    "soft": "#a3aebb",
    "faint": "#37414d",
    "link": "#e3e9f0",
    "alarm": "#ff8a4c",
    "warn": "#f0c04a",
    "good": "#4fd0a0",
    "accent": "#6db8f2",
}
_PORTS_LIGHT = (
    "#7db7e0", "#f0b545", "#6cc5a6", "#df9fc4", "#b9dcf2", "#ece37a", "#c9a98a", "#bdbdbd",
)  # fmt: skip
_PORTS_DARK = (
    "#205f8f", "#98690b", "#147056", "#8a4670", "#4888ad", "#837c1d", "#6f4f33", "#5e5e5e",
)  # fmt: skip
_DEPTH_LIGHT = (
    "#eff5fb", "#dfebf6", "#cde0f1", "#b9d4ea", "#a2c7e3", "#8ab9db", "#71a9d2", "#5899c8",
)  # fmt: skip
_DEPTH_DARK = (
    "#18222c", "#1b2b39", "#1e3547", "#213f56", "#254a66", "#295677", "#2e6389", "#34719c",
)  # fmt: skip
_HEAT_LIGHT = (
    "#f6f3ee", "#fbe6c8", "#fbd39c", "#f8bd72", "#f2a24c", "#e6852d", "#d26716", "#b34a08",
)  # fmt: skip
_HEAT_DARK = (
    "#2b2722", "#3d2f1f", "#573c1b", "#764d1b", "#98611f", "#bb7a2b", "#dc9845", "#ffbd70",
)  # fmt: skip

_SHAPES = "\n" + Path(__file__).with_name("shapes.css").read_text(encoding="utf-8")


def _variables(names: dict[str, str], dark: bool) -> str:
    families = {
        "p": _PORTS_DARK if dark else _PORTS_LIGHT,
        "d": _DEPTH_DARK if dark else _DEPTH_LIGHT,
        "h": _HEAT_DARK if dark else _HEAT_LIGHT,
    }
    words = [f"--{name}:{colour}" for name, colour in names.items()]
    for letter, colours in families.items():
        words += [f"--{letter}{i}:{colour}" for i, colour in enumerate(colours)]
    return ";".join(words)


def _fills() -> str:
    return "".join(f".{x}{i}{{fill:var(--{x}{i})}}" for x in "pdh" for i in range(SHADES))


def variables() -> str:
    """The colours as CSS variables: light, dark where the reader prefers it, light on paper."""
    light, dark = _variables(_LIGHT, False), _variables(_DARK, True)
    return (
        f":root{{color-scheme:light dark;{light}}}\n"
        f"@media (prefers-color-scheme:dark){{:root{{{dark}}}}}\n"
        f"@media print{{:root{{color-scheme:light;{light}}}}}\n"
    )


def drawing_style() -> str:
    """The style sheet of drawings, as a page or a drawing alone needs it."""
    return variables() + _SHAPES + _fills()


def shade(value: float, most: float) -> int:
    """Which of the shades 0 .. SHADES-1 stands for a value of 0 .. most."""
    if most <= 0:
        return 0
    return min(SHADES - 1, max(0, int(SHADES * value / most)))
