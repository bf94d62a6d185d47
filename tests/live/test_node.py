import pytest

from tests.live.net import Mesh


def test_a_path_is_known_by_its_port_and_no_other():
    node = Mesh(3, [(0, 1), (0, 2)]).nodes[0]
    assert [node.path_at(port) for port in (0, 1)] == node.paths
    for port in (-1, 2):
        with pytest.raises(ValueError, match=rf"no port {port}; this node has 0 to 1"):
            node.path_at(port)
