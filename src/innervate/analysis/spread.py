"""Where to draw nodes of which only the links are known."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import Any

import numpy as np


def spread(count: int, links: Iterable[tuple[int, int]]) -> Any:
    """x, y of every node: as far apart as they are in hops, about one from the next.

    Args:
        count: of nodes.
        links: pairs of nodes.
    """
    pairs = list(links)
    if count < 3 or not pairs:
        turn = 2 * math.pi * np.arange(count) / max(1, count)
        return max(1.0, count / 6) * np.stack([np.sin(turn), -np.cos(turn)], axis=1)
    far = np.full((count, count), np.inf)
    np.fill_diagonal(far, 0)
    for a, b in pairs:
        far[a, b] = far[b, a] = 1
    for middle in range(count):
        far = np.minimum(far, far[:, middle : middle + 1] + far[middle])
    far[np.isinf(far)] = far[np.isfinite(far)].max() + 1
    return _scaled(far)


def _scaled(far: Any) -> Any:
    """Places whose distances are about those given (classical scaling)."""
    squares = far**2
    centred = -0.5 * (
        squares - squares.mean(axis=0) - squares.mean(axis=1)[:, None] + squares.mean()
    )
    values, vectors = np.linalg.eigh(centred)
    places = vectors[:, :-3:-1] * np.sqrt(np.maximum(values[:-3:-1], 0.0))
    # Signs of eigenvectors are arbitrary; who is as far from everybody would lie on one place.
    places = places * np.where(places[0] > 0, -1.0, 1.0)
    turn = np.arange(len(places)) * 2.4
    return places + 0.15 * np.stack([np.cos(turn), np.sin(turn)], axis=1)
