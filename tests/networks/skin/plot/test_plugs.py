"""Plugs of interface ports stand beside their cells, as far as the drawing goes."""

import pytest

from innervate.networks.skin.plot.sheet import Sheet
from innervate.topology import from_patches
from innervate.topology.patch import DOWN, UP, E, W

WAY = {W: (-1.0, 0.0), E: (1.0, 0.0), UP: (0.0, -1.0), DOWN: (0.0, 1.0)}


@pytest.mark.parametrize(("pitch", "side", "found"), [
    (22.9, W, W), (22.9, E, E), (23.4, W, UP), (23.4, E, UP), (23.4, DOWN, DOWN),
    (25.8, UP, UP), (25.8, DOWN, DOWN), (25.9, UP, None), (25.9, DOWN, None),
])  # fmt: skip
def test_a_plug_looks_where_its_port_does_unless_the_edge_is_too_near(pitch, side, found):
    """12 px from the sides, 9 from above and below; else it stands where there is room, aslant."""
    graph = from_patches([(1, 1, "Z")])
    graph.add_interface(0, side)
    sheet = Sheet(graph, (80 + pitch, 80 + pitch))
    assert (sheet.width, sheet.height, sheet.pitch) == pytest.approx((80, 80, pitch))
    x, y = WAY[found] if found is not None else (0.5**0.5, 0.5**0.5)
    assert sheet.ports == [pytest.approx((40 + 1.2 * pitch * x, 40 + 1.2 * pitch * y))]
