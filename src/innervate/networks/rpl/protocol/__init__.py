"""RPL: routes to a root, and from it, over links that lose frames.

Numbers in brackets are sections of RFC 6550, if no other RFC is named. A test holds all names and
numbers here against the code, and that every branch by which a handler hands an event on has its
row.

Theory of operation
===================
RFC 6550 with Trickle (RFC 6206) and the objective function MRHOF (RFC 6719) on ETX. Every node
says in DIOs how far it is from the root, its rank; who has a lower rank can be a parent. DAOs tell
the way down: in storing mode to every ancestor, in non-storing mode to the root alone, which then
writes whole ways into packets. What packets carry of ranks finds loops.

*Rank* [8.2; RFC 6719, 3]. A path costs the neighbour's rank and the ETX of the link to it; the
cheapest is taken, a parent that we have is kept unless that saves `switch`. Our rank is the
greater of the parent's rank + max(ETX, `step`) and the next multiple of `step` above the parent's
rank (`rank_through`). In one version it never exceeds the lowest that we advertised, L, by more
than `increase`.

*Links.* ETX is guessed from the first frame's loudness (`guess`), then learned from hops'
acknowledgements. `GIVEN_UP` frames in a row without one, and the neighbour is not reachable; its
next DIO says that it is, and ETX is guessed anew.

*Packets* go up to the parent. In storing mode they turn down where somebody knows the way; who
cannot pass one further down returns it [11.2.2.3]. In non-storing mode they turn at the root.

Left out: several instances and DODAGs, several roots, floating DODAGs (MRHOF recommends none),
options (all nodes have the configuration in their parameters), multicast, security, DAO-ACKs in
storing mode (hops acknowledge), probing of links that are not used, messages to a neighbour past
its parent. A packet that a parent does not take goes to the next parent, which is more than the
RFC asks for.

Read `counters.py`, `trickle.py`, `parents.py`, `downward.py`, `sending.py`, `node.py`. Beside them
`packets.py` is the ring of packets, `constants.py` and `fields.py` what all share.

States
======
| machine              | states                                                                    |
|----------------------|---------------------------------------------------------------------------|
| node                 | unknown (`known` = 0); detached (`rank` is `INFINITE`); joined (`parent`  |
|                      | is a place among neighbours); root (`rank` is `step`)                     |
| Trickle interval     | before t (`phase` = 0); after t (`phase` = 1)                             |
| neighbour, a place   | free (`nbr` is `NONE`); here; lost (`nbr_fails` reached `GIVEN_UP`)       |
| target, at a node    | no way (`via` is `NONE`); a way                                           |
| ... to our parent    | `owed`: 0 nothing; `HERE = 1`; `GONE = 2`                                 |
| ... to one that we   | `left`: 0 nothing; 1 a No-Path is owed to `old`                           |
| left                 |                                                                           |
| our DAO              | none; delayed (`dao_armed`); due (`dao_due`); non-storing: sent           |
|                      | `dao_wait` times                                                          |
| sending, `under`     | `IDLE = 0`; `A_DIO = 1`; `A_DIS = 2`; `A_DAO = 3`; `A_PACKET = 4`         |
| ... `waiting`        | 0 not on its way, or not yet gone; 1 its acknowledgement is waited for    |

Events and transitions
======================
Whoever is heard, but for an `ACK`, gets a place (`meet`), if need be of the neighbour of highest
rank (`farthest`). What is for us alone is acknowledged at once (`acknowledge`), and ignored if its
`dsn` is that of the last such frame from its sender.

| frame                           | what is done                                                   |
|---------------------------------|----------------------------------------------------------------|
| `DIO`                           | `hear_dio`: note rank, version, DTSN; `choose`; a consistent   |
|                                 | one counts for Trickle (`note_consistent`); a newer DTSN of    |
|                                 | the parent asks for DAOs. The root: `hear_at_root`             |
| `DIS`                           | `reset_trickle`, unless unknown                                |
| `DAO`, not from our parent      | `take_dao`, `learn` its targets; news is told on: `schedule`   |
| `ACK`                           | `acked`, if it is for the frame that waits: `learn_etx`;       |
|                                 | `drop_first`, `told` or `told_left`                            |
| any packet                      | `take_packet`: `is_astray`, then `consume` or `keep`           |
| ... `DATA`, ours                | `hand_up`                                                      |
| ... `DAO_ACK`, ours             | our DAO is owed no more, if `path` is `path_seq`               |
| ... `DAO_UP`, at the root       | `take_report`, `answer`                                        |
| ... `ROUTE_ERROR`, at the root  | `forget` who was not reached                                   |
| ... its ranks do not fit        | the first time 'R' is set; then REPORT_LOOP, `reset_trickle`   |
| ... 'F', from the way to `dest` | `forget` that way, `schedule`; it goes another way, or up      |
| ... not ours, `hops` at most 1  | REPORT_HOPS                                                    |

| state     | event                             | action                               | next      |
|-----------|-----------------------------------|--------------------------------------|-----------|
| off       | on, or memory lost                | `on_start`; the root begins Trickle  | unknown   |
| unknown   | `DIO`                             | `hear_dio`, `migrate`                | detached  |
| not root  | `DIO` of a newer version          | `hear_dio`, `migrate`, `forget_all`  | detached  |
| detached  | ... in the same call, or another  | `choose`, `follow`, `announce` or    | joined    |
|           | that `cost_of` allows             | `announce_all`                       |           |
| joined    | cheaper by `switch` or more       | `follow`, `leave`, as above          | joined    |
| joined    | another whole rank (`dag_rank`)   | `follow`, `reset_trickle`            | joined    |
| joined    | no parent left, or `is_too_high`  | `detach`: a DIO of infinite rank     | detached  |
| joined    | the parent's `DIO` of an older    | `hear_dio`: `choose`                 |           |
|           | version                           |                                      |           |
| detached  | `TICK`, `hold` is over            | `tick`: no `floor`, `choose`         |           |
| no parent | `TICK`                            | `tick`: a DIS, below; after          |           |
|           |                                   | `patience` ticks `flush`             |           |
| any       | `TICK`, every `refresh`           | `tick`: `grow_older`; joined:        |           |
|           |                                   | `announce`                           |           |
| root      | `TICK`, every `repair`            | `tick`: `new_version`                | root      |
| root      | `DIO` of another, no older version| `hear_at_root`, `new_version`        | root      |
| root      | the first `DIO` after memory was  | `hear_at_root`, `new_version`        | root      |
|           | lost, of our version              |                                      |           |
| IDLE      | something is due                  | `go`: DIO, DIS, DAO, first packet    | `A_DIO` ..|
| A_DIO,    | `on_sent`                         | `sent`                               | `IDLE`    |
| A_DIS     |                                   |                                      |           |
| the other | `on_sent`, it has left            | `sent`: set `ACK_WAIT`               | waiting   |
| the other | `on_sent`, the channel was busy   | `sent`, `missed`, as below           |           |
| waiting   | `ACK`                             | `acked`, `choose`, `go`              | `IDLE`    |
| waiting   | `ACK_WAIT`                        | `missed`, `transmit` again           | under way |
| waiting   | ... `transmissions` are over      | `missed`, `note_failure`, `choose`   | `IDLE`    |
| ... DAO   |                                   | `schedule`; to `old`: let it be      |           |
| ... packet|                                   | `turn_back`: to whom is next, up to  |           |
|           |                                   | `reroutes` times; `lose_child` if it |           |
|           |                                   | went down to one that is lost; on a  |           |
|           |                                   | source route, dropped: `tell_root`   |           |

Detached, a neighbour may be a parent only below `floor`, the rank that we had, until `hold` ticks
are over. A packet waits while there is no parent; one without a way is dropped (`give_up`).

Without a parent a DIS is sent in ticks 1, 2, 4, 8, 16, 32 and 64, and from there on in every 64th:
`lonely` is counted up to `LONELY_MAX = 255`, and on from 192 (`RARELY = 63` ticks between two).

Timers
======
`TIMERS = 4` of them.

| timer           | what is done                                                                   |
|-----------------|--------------------------------------------------------------------------------|
| `TRICKLE = 0`   | `interval_point`: at t a DIO is due, unless `dio_k` consistent ones were       |
|                 | heard; at the interval's end the next, twice as long. t is drawn in its second |
|                 | half (`begin_interval`)                                                        |
| `ACK_WAIT = 1`  | `missed`, if `waiting`; `ack_us` after the frame has left                      |
| `DAO_DELAY = 2` | `delay_over`: the DAO; set for 1 to 2 `dao_us` if it does not run (`schedule`).|
|                 | Non-storing: again after `AGAIN = 8` `dao_us`, `DAO_TRIES = 5` times at most   |
| `TICK = 3`      | `tick`: every `tick_us`, the first after a random part of it                   |

An interval is 2^`dio_min` ms (`MS = 1000` us), doubled up to `dio_doublings` times, at most to
2^19 ms (`LONGEST = 19`). `reset_trickle` begins a shortest one, unless it is that already.

Frames
======
| frame              | to                  | says                                                |
|--------------------|---------------------|-----------------------------------------------------|
| `DIO = 1`          | all in reach        | version, rank, DTSN, mode                           |
| `DIS = 2`          | all in reach        | that DIOs are wanted                                |
| `DAO = 3`          | a parent, storing   | targets, Path Sequences, for how long (`life`)      |
| `ACK = 4`          | the hop before      | the number of its frame; sent URGENT                |
| `DATA = 5`         | a hop               | what users say                                      |
| `DAO_ACK = 8`      | a hop, non-storing  | the Path Sequence, from the root                    |
| `DAO_UP = 11`      | a hop, non-storing  | whose parent is who, and the Path Sequence          |
| `ROUTE_ERROR = 12` | a hop, non-storing  | who on a source route was not reached               |

DATA and DAO_ACK are one more with a source route of up to `NEAR = 4` hops behind the first, two
more with one of up to `ROUTE = 16`. All packets have origin, destination, hops left, the flags 'O'
(`down`), 'R' (`error`), 'F' (`back`) and the rank of who sent them [11.2]: 0 says that it is their
origin. The layouts stand beside this folder.

A Path Lifetime, `life`, counts ticks from when a Path Sequence is first seen [6.7.8]: 0 is a
No-Path, `FOR_EVER = 255` has no end. Whoever passes a target on says how long its own word is good,
`LIFE` times `refresh`, and sends a No-Path when its own way ends.

Inputs and reports
==================
Inputs: `MESSAGE = 1` to somebody, `ALARM = 2` to the root; to ourselves they are ignored.

| report                | meaning                                                                  |
|-----------------------|--------------------------------------------------------------------------|
| `REPORT_NO_ROUTE = 1` | a packet for a was dropped: no way; b others wait                        |
| `REPORT_FULL = 2`     | a packet for a found no place                                            |
| `REPORT_LOOP = 3`     | a packet of b for a was dropped: its ranks did not fit twice             |
| `REPORT_DETACHED = 4` | no parent any more; the rank was a                                       |
| `REPORT_PARENT = 5`   | a is the preferred parent now; our rank is b                             |
| `REPORT_VERSION = 6`  | a member of version a                                                    |
| `REPORT_HOPS = 7`     | a packet of b for a was dropped: its hop limit                           |

Constants and settings
======================
| name                                 | is                                                        |
|--------------------------------------|-----------------------------------------------------------|
| `NODES = 254`, `NEIGHBOURS = 24`,    | places: for targets, neighbours, packets                  |
| `QUEUE = 6`                          |                                                           |
| `BODY = 8`, `TARGETS = 4`            | numbers of a message, 2 bytes each; targets of a DAO      |
| `OUTBOX = 55`                        | actions that a call puts out at most                      |
| `INFINITE = 65535`                   | INFINITE_RANK [17]                                        |
| `INITIAL = 240`, `WINDOW = 16`,      | sequence counters [7.2]: where they begin,                |
| `CIRCULAR = 128`                     | SEQUENCE_WINDOW, below it they go round                   |
| `ETX_ONE = 128`, `ETX_MOST = 4096`   | an ETX of 1 [RFC 6719, 3.5]; the most                     |
| `COST_MAX = 32768`                   | MAX_PATH_COST [RFC 6719]                                  |
| `NO_WAY = 1048576`                   | a cost beyond all: no parent                              |
| `GIVEN_UP = 2`                       | frames without an acknowledgement, then it is lost        |
| `KEPT = 3`, `OF = 4`                 | 3/4 of an ETX stay, 1/4 is the new sample                 |
| `LIFE = 3`                           | times from DAO to DAO, then a way is forgotten            |
| `NONE = -1`, `NOBODY = 255`          | no place, no node                                         |
| `STAY = -2`                          | no next hop yet                                           |
| `CLOCK = 1073741823`                 | clocks wrap at 2^30                                       |

| setting         | by itself | is                                                               |
|-----------------|-----------|------------------------------------------------------------------|
| `root`          |           | the DODAG's root                                                 |
| `storing`       | 1         | storing mode; 0 non-storing                                      |
| `dio_min`       | 6         | DIOIntervalMin, bits of ms                                       |
| `dio_doublings` | 8         | DIOIntervalDoublings                                             |
| `dio_k`         | 10        | DIORedundancyConstant; 0 suppresses none                         |
| `step`          | 128       | MinHopRankIncrease                                               |
| `increase`      | 1024      | MaxRankIncrease; 0 allows any                                    |
| `switch`        | 192       | PARENT_SWITCH_THRESHOLD, x 128                                   |
| `link_max`      | 512       | MAX_LINK_METRIC, x 128                                           |
| `half_dbm`      | -95       | loudness at which half of the frames come, for the first guess   |
| `ack_us`        | 1500      | until a hop's acknowledgement is missing                         |
| `transmissions` | 4         | of a frame to one neighbour                                      |
| `reroutes`      | 3         | times that a packet is given again when it was not acknowledged  |
| `dao_us`        | 200000    | DelayDAO                                                         |
| `tick_us`       | 500000    | a tick                                                           |
| `hold`          | 2         | ticks from poisoning to looking for a parent further down        |
| `patience`      | 4         | ticks for which packets wait for a parent                        |
| `refresh`       | 60        | ticks from DAO to DAO                                            |
| `repair`        | 0         | ticks from version to version; 0 no global repair                |
| `hops`          | 32        | a packet's hop limit                                             |

What holds, and under what assumption
=====================================
Assumed: frames are whole and nobody lies; any may be lost; nodes die and come back without memory.

- A rank is greater than what the parent last advertised, and the parent is of our version; who has
  no parent has infinite rank. All that is so by what we *heard*: where DIOs are lost, parents may
  form a loop for a while.
- A packet in a loop ends: the second time that ranks do not fit, or at its hop limit.
- In one version a rank is at most L + `increase`, unless that is 0; L does not outlive a restart.
- At most one frame is under way, but for acknowledgements; only then is one waited for.
- Nothing says that a message arrived, and a hop acknowledges also what finds no place. A message
  may come twice: when only acknowledgements were lost, it is given to somebody again.
- Who restarts begins counters at 240, newer than any that has gone round, but 0; where the old one
  had not, its DAOs are old by the words of [7.2] until they have counted past it, or for `LIFE`
  times `refresh`, when the way is forgotten.
"""
