"""What must hold of RPL, whatever happens."""

from innervate.networks.rpl.protocol.constants import INFINITE


def node_is_above_its_parent(node, params, now):
    """a rank is not greater than that of the preferred parent"""
    return node.parent < 0 or node.rank > node.nbr_rank[node.parent]


def node_with_a_parent_is_of_its_version(node, params, now):
    """the preferred parent is of another DODAG version"""
    return node.parent < 0 or node.nbr_version[node.parent] == node.version


def node_without_a_parent_is_at_infinity(node, params, now):
    """a node has a rank and no parent, or a parent and no rank"""
    if node.number == params.root:
        return node.parent < 0 and node.rank == params.step
    return (node.parent < 0) == (node.rank == INFINITE)


def node_moves_down_no_further_than_allowed(node, params, now):
    """a rank is above L + MaxRankIncrease"""
    if node.rank == INFINITE or params.increase == 0:
        return True
    return node.rank <= node.lowest + params.increase


def node_has_one_frame_under_way(node, params, now):
    """an acknowledgement is waited for while nothing is under way"""
    return node.under > 0 or node.waiting == 0
