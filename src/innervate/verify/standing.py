"""Nodes whose time stands still: timers that are due at once set timers that are, for ever."""

from innervate.dialect.bounded import AGAIN, AT_ONCE_MOST
from innervate.verify.net import Net
from innervate.verify.states import Node, State


def wrong_of(net: Net, state: State) -> str:
    """What is wrong with a state itself, however it came to be; "" if nothing is."""
    return (net.of_all and net.broken_of_all(state)) or _standing(net, state)


def _standing(net: Net, state: State) -> str:
    for number, node in enumerate(state.nodes):
        if _is_due(node) and not _goes_on(net, state, number):
            return f"on_timer of {net.graph.label(number)} {AGAIN}"
    return ""


def _is_due(node: Node) -> bool:
    """True if a timer of the node fires before any time passes; every state is asked: plainly."""
    for _, wait in node.timers:  # noqa: SIM110
        if wait <= 0:
            return True
    return False


def _goes_on(net: Net, state: State, number: int) -> bool:
    """True if a node's timers are not due at once for ever, draws as a stream has them."""
    alone = Net.__new__(Net)  # what is looked at here is no event, and noted nowhere
    vars(alone).update(vars(net) | {"readings": None})
    seen: list[Node] = []
    with net.draws.by_chance():
        for _ in range(AT_ONCE_MOST):
            node = state.nodes[number]
            if not _is_due(node) or node in net.moving:
                net.moving.update(seen)
                return True
            seen.append(node)
            state, broken = alone.fire(state, number)
            if broken:
                return True
    return False
