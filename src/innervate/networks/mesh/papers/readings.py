"""The labels of our readings of the mesh's document, A1 to A15, a sentence each."""

from innervate.papers.words import sentences

READINGS = sentences(
    """
A1: Who hears a discovery answers once, with a list of all neighbours it heard; answering once
along the tree finds too few links, answering each request too many times.
A2: The next hop to the gateway is the best of the neighbours that are nearer, not the first that
was heard; tree and each of A1 come with the first if nothing is said, a choice of ours: uplink.
A3: "Does not get an ack" means after three transmissions.
A4: The packet that was not acknowledged is sent another way, not lost.
A5: A neighbour that does not answer is suspected for 10 s; tables are not rewritten.
A6: "Pick a neighbour" takes alternates first and then searches along the packet's path.
A7: "Except packet source" excludes the previous hop, and in a search all of the path.
A8: A neighbour that is suspected is avoided for all destinations.
A9: Packets carry their path and at most 24 hops; a limit of hops alone only shortens loops.
A10: The newest table counts at once.
A11: Tables go out by source routes along the graph, so that neither way needs tables.
A12: A packet is a duplicate only for a node that is not on its path.
A13: A crossing is detected by the robot, by the watchdog for silence, and by witnesses of its
beacons.
A14: Any node can be the monitor; the address 0xFE follows the gateway.
A15: An answer may go from a child to its parent's parent once.
"""
)
