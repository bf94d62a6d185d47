"""Where to draw nodes of which only the links are known."""

import math
from collections.abc import Iterable
from typing import Any

import numpy as np

EQUAL = 1e-6  # relative: what differs by less is the same, as far as rounding goes


def spread(count: int, links: Iterable[tuple[int, int]]) -> Any:
    """x, y of every node: as far apart as they are in hops, about one from the next."""
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
    aside = np.arange(count) * 2.4
    # Who is as far from everybody as another would lie on one place with it.
    return scaled(far) + 0.15 * np.stack([np.cos(aside), np.sin(aside)], axis=1)


def laid_out(nodes: list[tuple[str, dict[str, Any]]], edges: Any) -> tuple[Any, str]:
    """Where the nodes of a graph are drawn: as their coordinates say, else by who is linked.

    Args:
        nodes: (name, attributes); `x_m`, `y_m` or `x_mm`, `y_mm` of all are where they lie.
        edges: (name of one end, of the other, attributes).

    Returns:
        x, y of each, (n, 2), and their unit: "m" or "mm"; "" where a link is about 1 long.
    """
    for unit in ("m", "mm"):
        if nodes and all({f"x_{unit}", f"y_{unit}"} <= about.keys() for _, about in nodes):
            spots = [(about[f"x_{unit}"], about[f"y_{unit}"]) for _, about in nodes]
            return np.array(spots, np.float64), unit
    number = {name: i for i, (name, _) in enumerate(nodes)}
    return spread(len(nodes), [(number[a], number[b]) for a, b, _about in edges]), ""


def scaled(far: Any) -> Any:
    """Places whose distances are about those given (classical scaling).

    Args:
        far: distance of each of n from each, (n, n), n >= 2.

    Returns:
        x, y of each, (n, 2), the longest extent across, the first up left. On any machine the same:
        where extents are equal, as in a ring, a fixed direction is taken rather than what comes.
    """
    squares = far**2
    centred = -0.5 * (
        squares - squares.mean(axis=0) - squares.mean(axis=1)[:, None] + squares.mean()
    )
    values, vectors = np.linalg.eigh(centred)
    chosen: list[Any] = []
    for place, value in enumerate(values[:-3:-1]):
        alike = vectors[:, np.abs(values - value) <= EQUAL * np.abs(values).max()]
        towards = alike @ (alike.T @ np.cos((1.3 + place) * np.arange(len(far))))
        for one in chosen:
            towards = towards - one * (one @ towards)
        chosen.append(towards / np.linalg.norm(towards))
    places = np.stack(chosen, axis=1) * np.sqrt(np.maximum(values[:-3:-1], 0.0))
    return places * np.where(places[0] > EQUAL * np.abs(places).max(), -1.0, 1.0)
