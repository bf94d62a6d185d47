"""RPL: routes to a root, and from it, over links that lose frames.

RFC 6550 with Trickle (RFC 6206) and the objective function MRHOF (RFC 6719) on ETX. Every node
says in DIOs how far it is from the root, its rank; who has a lower rank can be a parent. DAOs tell
the way down: in storing mode to every ancestor, in non-storing mode to the root alone, which then
writes whole ways into packets. What packets carry of ranks finds loops.

Read counters.py, trickle.py, parents.py, downward.py, sending.py, this. Left out: several
instances and DODAGs, several roots, floating DODAGs (MRHOF recommends none), options (all nodes
have the configuration in their parameters), multicast, security, DAO-ACKs in storing mode (hops
acknowledge), probing of links that are not used, messages to a neighbour past its parent. A packet
that a parent does not take goes to the next parent, which is more than the RFC asks for.
"""
