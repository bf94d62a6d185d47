"""Babel [RFC 8966] for one source: every node finds its way to the PC over cables, and mends it.

Numbers in brackets are sections of the RFC. A cable is an interface with one neighbour, so that
both tables of neighbours and of routes have an entry a port. The source is the node `pc`; it has a
route of metric 0, and data goes to it hop by hop.

*Links* [3.4, A.1, A.2]. Every node sends a numbered Hello on each port, and with it (IHU) what
came of the neighbour's. A link costs C if k of the last j Hellos came in both directions, or
256 / (alpha beta) by ETX; without Hellos it costs infinitely much.

*Routes* [3.5, 3.6]. An update says (seqno, metric). It is feasible if it is strictly better than
the best that we have ever advertised; of the feasible routes the one with the least metric is
selected. So next hops never form a loop, as long as nobody loses its memory.

*Requests* [3.8]. Who has no feasible route left asks for a greater seqno; the request goes hop by
hop to the source, which counts up by one. Retractions and news go out at once, and twice.

Left out, since the job has one source and cables: prefixes and router-ids, TLVs and their packets,
multicast and unicast Hellos as two things, acknowledgments (retractions are repeated instead
[3.7.2]), jitter (clocks run free), smoothed metrics (`margin` is the hysteresis [3.6]), and
authentication.
"""
