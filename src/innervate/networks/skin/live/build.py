"""From a node file to a cell, or to the PC."""

from innervate.live.build import links_of, sealer_of, state_of
from innervate.live.errors import LiveError
from innervate.live.machine import machine
from innervate.live.node import LiveNode
from innervate.live.nodefile import Loaded
from innervate.networks.skin.live.node import CellNode, SinkNode
from innervate.networks.skin.live.nodefile import SkinFile
from innervate.networks.skin.live.parameters import skin_parameters
from innervate.networks.skin.live.stack import CellStack, SinkStack
from innervate.networks.skin.protocol.constants import PORTS


def build(loaded: Loaded) -> LiveNode:
    """The node of a file, not yet started; a LiveError says what cannot be as written."""
    table, links, state = loaded.table, links_of(loaded), state_of(loaded)
    assert isinstance(table, SkinFile)
    params = skin_parameters(dict(table.protocol), f"{loaded.path}")
    paths = sum(len(link.paths) for link in links)
    sealer = sealer_of(loaded, state)
    if table.role == "sink":
        pc = SinkNode(loaded.name, SinkStack(params, paths), links, sealer, state)
        if table.nodes is not None:  # the last number may be its own
            pc.cell_max = table.nodes - 1 - (table.number == table.nodes - 1)
            pc.knows_cells = True
        return pc
    ports = table.ports or list(range(paths))
    if len(ports) != paths or len(set(ports)) != paths or paths > PORTS:
        raise LiveError(
            f"{loaded.path}: ports must name the cell's port of each of its {paths} paths, "
            "each once: W, E, up, down = 0 to 3"
        )
    stack = CellStack(table.number, params, machine().chance.getrandbits(60), ports)
    cell = CellNode(loaded.name, stack, links, sealer, state)
    cell.rate_hz = table.rate_hz
    return cell
