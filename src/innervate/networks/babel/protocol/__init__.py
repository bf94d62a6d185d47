"""Babel [RFC 8966] for one source: every node finds its way to the PC over cables, and mends it.

Numbers in brackets are sections of the RFC. A test holds all names and numbers here against the
code; what the RFC says is held, sentence by sentence, in `tests/networks/babel`.

Theory of operation
===================
A cable is an interface with one neighbour, so that the tables of neighbours and of routes have an
entry a port. The source is the node `pc`: it has a route of metric 0, and data goes to it hop by
hop.

*Links* [3.4, A.1, A.2]. Every node sends a numbered Hello on each port, and with it (IHU) what
came of the neighbour's. A link costs C if k of the last j Hellos came in both directions, or
256 / (alpha beta) by ETX; without Hellos it costs infinitely much.

*Routes* [3.5, 3.6]. An update says (seqno, metric). It is feasible if it is strictly better than
the best that we have ever advertised; of the feasible routes the one with the least metric is
selected. So next hops never form a loop, as long as nobody loses its memory.

*Requests* [3.8]. Who has no feasible route left asks for a greater seqno; the request goes hop by
hop to the source, which counts up by one. Retractions and news go out at once.

*Left out*, since the job has one source and cables: all prefixes but the source's, Unicast Hellos,
requests for acknowledgments (retractions are repeated instead [3.7.2]; they are answered), jitter
(clocks run free), smoothed metrics (`margin` is the hysteresis [3.6]), authentication. Sequence
numbers of the source outlive a restart, as in stable storage. Packets [4] are beside this folder.

`node.py` has the functions; `links.py`, `routes.py`, `updates.py`, `requests.py` one table each;
`common.py` what they share.

States
======
| machine            | states                                                                     |
|--------------------|----------------------------------------------------------------------------|
| neighbour, a port  | none (`neighbour` is `NONE = -1`); heard (`history`); up (`cost` below     |
|                    | `INFINITY = 65535`)                                                        |
| route, a port      | none (`known` = 0); finite; retracted (`metric` infinite), until it expires|
| node               | no route (`parent` is NONE); routed                                        |
| seqno request      | none (`wanted` = 0); sent, `wanted_tries` more; handed on, none more       |
| triggered update   | none (`soon` = 0); soon, and `copies` more                                 |

Events and transitions
======================
| frame                | what is done                                                             |
|----------------------|--------------------------------------------------------------------------|
| `HELLO = 1`          | `hear`: history, txcost, `judge` the link; a new neighbour is asked for  |
|                      | its route; the update in it: `take`; `select`                            |
| `UPDATE = 2`         | `take` into the route table, or `ask` if it is not feasible; `select`    |
| `ROUTE_REQUEST = 3`  | `send_update`: our route, or that we have none                           |
| `SEQNO_REQUEST = 4`  | `take_request`: the PC counts up; who can answers; others hand it        |
|                      | `onward`                                                                 |
| `DATA = 5`           | `forward` to the next hop; at the PC it is delivered                     |
| `IHU = 6`            | `hear_ihu`: txcost, `judge` the link; `select`                           |
| `ACK_REQUEST = 7`    | `frame_to` its sender: an `ACK = 8`, of which nothing comes there        |

| state    | event                                   | action                      | next      |
|----------|-----------------------------------------|-----------------------------|-----------|
| off      | on, or memory lost                      | `on_start`                  | no route  |
| no route | a feasible finite route over an up link | `select`, `trigger`         | routed    |
| routed   | another is better by more than `margin` | `select`, `trigger`         | routed    |
| routed   | nothing feasible is left                | `select`: retract, `ask`    | no route  |
| sent     | no answer in time                       | `look`, `send_request`      | sent, none|
| any      | a route with the seqno wanted           | `select`, `trigger`         | none      |
| heard    | Hellos missing, IHU too old             | `look_at_link`, `judge`     | heard     |
| heard    | none of 16 Hellos came                  | `look_at_link`,             | none      |
|          |                                         | `forget_neighbour`          |           |
| finite   | about to expire, and selected           | `look_at_route`: ask for it | finite    |
| finite   | expired                                 | `look_at_route`             | retracted |
| retracted| expired                                 | `look_at_route`             | none      |

Timers
======
`TIMERS = 3` of them.

| timer      | what is done                                                                       |
|------------|------------------------------------------------------------------------------------|
| `TICK = 0` | `tick`: a Hello with its IHU on every port, after `update_hellos` with an update   |
| `LOOK = 1` | `look` at all that may have expired, `select`; set again for the next (`arm`)      |
| `SOON = 2` | `send_update` on all ports but the next hop's; of a retraction `trigger` its copies|
|            | (`own_metric`)                                                                     |

Frames
======
Their layouts stand beside this folder. Times in them are in units of `TENTH_MS = 100` us. A seqno
request may go `HOPS_MAX = 64` hops, and data no more.

Inputs and reports
==================
Any input is data for the PC. Reports: `REPORT_ROUTE = 1` (port, neighbour; -1 none),
`REPORT_DROP = 2` (hops; data without a route, or that went too far), `REPORT_LINK = 3` (port, 1 up
0 down).

Constants and settings
======================
`PORTS = 4`; a request is sent `TRIES = 3` times more, `WANTED_MAX = 16000000` us apart at most; a
frame says of an update that the next comes within `SAID_MAX = 6553500` us at most, so that updates
come as often; a call puts at most `OUTBOX = 34` actions.
Settings, by themselves those of appendix B with a Hello every 4 ms instead of 4 s, all other times
in proportion:

| setting         | by itself | is                                                                 |
|-----------------|-----------|--------------------------------------------------------------------|
| `pc`            |           | the source                                                         |
| `hello_us`      | 4,000     | between two Hellos                                                 |
| `update_hellos` | 4         | Hellos between two updates                                         |
| `etx`           |           | 1: links are judged by ETX                                         |
| `up_least`      | 2         | k: so many Hellos ...                                              |
| `up_of`         | 3         | j: ... of the last so many make a link up                          |
| `nominal`       | 96        | C: the cost of a link that is up                                   |
| `margin`        |           | by which another route must be better                              |
| `urgent_us`     | 200       | until a triggered update                                           |
| `copies`        | 2         | of a retraction                                                    |
| `request_us`    | 2,000     | until a request is sent again, doubled each time                   |
| `gc_us`         | 180,000   | until a feasibility distance is forgotten                          |

What holds, and under what assumption
=====================================
Next hops form no loop, and the feasibility distance of a next hop is strictly better than ours
[2.4], while no node loses its memory and feasibility distances outlive (`gc_us`) whatever is said
of older ones. The explorer and random walks look at both.
"""
