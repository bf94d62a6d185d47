"""What must hold of managed flooding, whatever happens."""

from innervate.networks.flooding.protocol.sizes import OWN, PLACES


def node_passes_on_what_may_still_go(node, params, now):
    """a packet waits that may go as far as when it began, or further"""
    for i in range(PLACES):
        if node.waits[i] and node.hops[i] >= node.start[i]:
            return False
    return True


def node_keeps_a_packet_once(node, params, now):
    """one packet waits in two places"""
    for i in range(PLACES):
        for j in range(i):
            if node.waits[i] and node.waits[j]:
                if node.origin[i] == node.origin[j] and node.packet[i] == node.packet[j]:
                    return False
    return True


def node_passes_on_no_packet_of_its_own(node, params, now):
    """an own packet waits to be passed on"""
    for i in range(PLACES):
        if node.waits[i] and node.origin[i] == node.number:
            return False
    return True


def node_sends_again_as_often_as_asked(node, params, now):
    """a packet was sent again more often than `retries` says"""
    for i in range(OWN):
        if node.open[i] and node.open_tries[i] > params.retries:
            return False
    return True
