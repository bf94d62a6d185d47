"""The picture of a body: its cells, and its ports where they are."""

from types import SimpleNamespace

import numpy as np
from matplotlib.figure import Figure

from innervate.networks.skin.plot.sizing import _map

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
