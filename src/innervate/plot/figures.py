"""Figures of a run of any network, for `Run.plot`: delivered, latency."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from innervate.plot import style


def draw(run: Any, figure: str = "delivered", **options: Any) -> Figure:
    """One of FIGURES of a run; save it with `.savefig`.

    Raises:
        ValueError: no figure of that name.
    """
    if figure not in FIGURES:
        raise ValueError(f'no figure "{figure}"; there are {", ".join(FIGURES)}')
    with style.house():
        return FIGURES[figure](run.result, **options)


def delivered(result: Any) -> Figure:
    """Messages delivered, and reports of nodes, so far, over time."""
    made, (ax,) = style.panels(style.COLUMN_IN, 2.2)
    for name, label in (("deliveries", "messages delivered"), ("rows", "reports")):
        if name in result.rows:
            times = np.sort(result.rows[name]["time"]) / 1e6
            ax.step(np.append(times, result.ended_us / 1e6),
                    np.append(np.arange(1, len(times) + 1), len(times)), where="post",
                    lw=1, label=label)  # fmt: skip
    ax.set_xlim(0, result.ended_us / 1e6)
    ax.set_xlabel("time (s)")
    ax.set_ylabel("so far")
    ax.legend()
    return made


def latency(result: Any) -> Figure:
    """Share of the messages that were delivered within a time."""
    made, (ax,) = style.panels(style.COLUMN_IN, 2.2)
    some = result.rows.get("deliveries")
    known = np.sort(some["latency"]) / 1e3 if some is not None else np.zeros(0)
    ax.step(known, np.arange(1, len(known) + 1) / max(1, len(known)), where="post", lw=1)
    ax.set_xlabel("latency (ms)")
    ax.set_ylabel("share delivered")
    ax.set_ylim(0, 1.02)
    return made


FIGURES: dict[str, Callable[..., Figure]] = {"delivered": delivered, "latency": latency}
