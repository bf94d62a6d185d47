"""The picture of a body: its cells, and its ports where they are."""

from types import SimpleNamespace

import numpy as np
import pytest
from matplotlib.figure import Figure

from innervate.networks.skin.plot.sizing import _curves, _map

PLACES = [[0, 0, 0], [9, 0, 1], [0, 0, 30], [9, 1, 30]]
JOINED = {0: [1, 2], 1: [0, 3, 4], 2: [0, 3, 4], 3: [1, 2], 4: [2, 1]}


def test_every_port_is_a_numbered_square_on_its_cell():
    positions = np.array(PLACES, np.float64).tobytes()
    graph = SimpleNamespace(cells=4, sink=4, positions=positions, neighbours=JOINED.get)
    ax = Figure().subplots()
    _map(ax, graph)
    squares = [line.get_xydata()[0] for line in ax.lines if line.get_marker() == "s"]
    (cells,) = (line.get_xydata() for line in ax.lines if line.get_marker() == "o")
    assert np.array_equal(squares, cells[[2, 1]])
    assert [note.get_text() for note in ax.texts] == ["0", "1"]
    assert [tuple(note.xy) for note in ax.texts] == [tuple(cells[2]), tuple(cells[1])]
    assert len([line for line in ax.lines if line.get_marker() == "None"]) == 4  # cables
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("x (mm), slanted by y", "z (mm)")


@pytest.mark.parametrize(("size", "axes"), [
    ((5, 9, 1), "yxz"), ((9, 5, 1), "xyz"), ((1, 5, 9), "yzx"), ((1, 9, 5), "yzx"),
    ((5, 1, 9), "xzy"),
])  # fmt: skip
def test_a_body_is_seen_from_where_it_is_thinnest(size, axes):
    """Broad rather than high; but what stands up does."""
    positions = np.array([(0, 0, 0), size], np.float64).tobytes()
    graph = SimpleNamespace(cells=2, sink=2, positions=positions,
                            neighbours={0: [1], 1: [0], 2: []}.get)  # fmt: skip
    ax = Figure().subplots()
    _map(ax, graph)
    across, up, along = axes
    assert ax.get_xlabel() == f"{across} (mm), slanted by {along}"
    assert ax.get_ylabel() == f"{up} (mm)"


def test_a_curve_for_every_rate_over_the_ports_that_have_an_answer():
    rows = [(1, 10, 0.5), (2, 10, 0.1), (1, 50, None), (2, 50, 0.4), (2, 90, None)]
    columns = {"ports": [one[0] for one in rows], "rate_hz": [one[1] for one in rows],
               **{f"lost_{part}": [one[2] for one in rows] for part in ("mean", "low", "high")},
               }  # fmt: skip
    ax = Figure().subplots()
    _curves(ax, columns, "lost", 100.0, 0.02)
    *curves, limit = ax.lines
    assert [(line.get_label(), line.get_xydata().tolist()) for line in curves] == [
        ("10 Hz", [[1, 50], [2, 10]]), ("50 Hz", [[2, 40]])]  # fmt: skip
    assert set(limit.get_ydata()) == {2.0}
    assert ax.get_legend() is not None
