"""The protocol of a mesh: its state machines and what they declare.

[mesh] is the document of a virtual fence on a field; A1 .. A15 are our readings (docs/readings.md,
decision 0014). A test holds all names and numbers here against the code, and that every branch by
which a handler hands an event on has its row.

Theory of operation
===================
Messages between any two of up to 254 nodes, relayed by the others. One node, the gateway, finds out
who hears whom, computes routes and hands them out; whoever does not answer is gone round at once.

*Discovery* [mesh 4]. Once a period the gateway floods a request. A node passes it on after a random
wait, notes whom it heard, and responds once (A1), up the neighbours that advertised less depth
(A2), else by who is as near, in the end by anybody (0080). A link counts if both directions were
reported within three rounds, or a response crossed it that no faint link brought (`WEAK`; 0052);
but whom nobody heard in this round, of two that did before and responded, is gone (decision 0064).
With `asks` the gateway asks those by name that others heard and that did not respond (0059). Who
knows no round asks for it: neighbours say their requests again, it joins late (decision 0065).

*Tables.* By breadth-first search the gateway makes for each node a next hop and an alternate per
recipient; alternates are loop-free (RFC 5286, 3.3). They go out source-routed, in acknowledged
parts, to the nearest of those first that were tried least; a whole table is in force at once (A10).
Instead, all can have the whole graph, or none a table, and the gateway writes routes into packets.

*Forwarding.* A hop takes a packet over by an ack; after three transmissions without one (A3) the
neighbour is suspect, and the same packet goes another way (A4): recipient, table, alternate,
uplink, any neighbour not on the packet's path; else back to its giver (A6, A7). A duplicate cache
drops what comes again (A12). To whom the table knows no way a packet goes up, where tables come
first, and whoever brought a packet, or what climbs, is the way to its origin (decision 0044). Who
gave one back comes last for that recipient, until it brings one from there, or some ticks are over.
With `on_demand` who has no table and knows no way floods the message; its ack leaves the way.

*End to end.* An origin keeps a message until its recipient acknowledges it; both keep to a window
of sequence numbers, so that a retransmission is delivered once. Timeouts adapt to round trips.

*Hops.* Where `ack_adapt` is on, a hop's ack may take the smoothed round trip to that neighbour and
four mean deviations [RFC 6298], never less than `ack_us`. Retried frames tell no round trip (Karn):
they double the wait, until one that was sent once is acknowledged; an ack of what was given up
tells how late it is. With `hop_frames` every neighbour has frames under way of its own, more of
them with each ack and half as many after a missing one; with `gather` all that came is handled
before something goes, and acks to one node go in one frame.

*Links.* Of each neighbour a node learns what share of its transmissions is acknowledged, the ETX of
the link. One that was heard in this tick is sent a frame the more often, the less it acknowledges.

*Backoff.* Acks that are missing beyond what the links explain make for growing pauses of searches,
then of all messages, never of alarms: a full channel heals (decision 0016). What looks for a way
there goes no further where many tries of a hop to who was heard failed: it is sent again (0083).

*Standby.* A standby that has no sign of the gateway's life until its second `guard_us` is over asks
it. Each answer brings a part of the graph, until it has all. Questions in vain, more where answers
used to be late: it leads. Its first request makes all tables its own: nobody responds but who has
none, and is sent one of the graph that came with the answers; all have new ones after the next
round (decision 0053). Nobody looks for the gateway that is `gone`, or goes by it, until it is
heard, or a table leads to it, or the round after the next begins. Questions, answers go first.

*Fence.* Robots judge their position at every sample; alarms are sent, flooded, retransmitted and
raised again until the monitor acknowledged them. Who hears a robot outside is its witness (A13).

`node.py` has the five functions and hands on: `round.py`, `gateway.py`, `paths.py`, `jobs.py`,
`graph_jobs.py`, `pack.py`, `table.py` discovery and tables; `relay.py`, `send.py`, `route.py`,
`search.py`, `upward.py`, `overheard.py` forwarding; `queue.py` what waits to be sent;
`messages.py`, `retransmission.py`, `timeout.py` end to end; `neighbours.py`, `duplicates.py`,
`backoff.py`, `hop.py`, `link_quality.py` what is remembered; `standby.py` who leads next;
`alarm.py`, `fence.py`, `watch.py` the fence; `frames.py` bytes. Below: `csma.py`, or a radio's.

States
======
| machine                               | states                                                   |
|---------------------------------------|----------------------------------------------------------|
| role                                  | unknown (`known` = 0); follows (`gateway`, `epoch`);     |
|                                       | leads (`leading` = 1); `rank` 0 is the gateway's, 1 and  |
|                                       | up the standbys', -1 all others'                         |
| round at a node, `due`                | `NOTHING = 0`; `LOOK_AGAIN = 1` heard weak requests      |
|                                       | only; `RESPOND = 2`                                      |
| round at the gateway, `step`          | `IDLE = 0`; `COLLECTING = 1`; `ASKED = 2` once more      |
| a node's table, at the gateway, `job` | `CURRENT = 0`; `TO_SEND = 1`; `UNDER_WAY = 2`;           |
|                                       | `GIVEN_UP = 3`                                           |
| the table that comes in               | none (`new_version` = 0); in `parts`; `ready`, waits for |
|                                       | activation                                               |
| entry of the queue, `q_state`         | `FREE = 0`; `WAITS = 1`; `DOWN = 2` handed down;         |
|                                       | `UNACKED = 3`                                            |
| message end to end, `wait_kind`       | `FREE`; else it waits for its ack                        |
| neighbour, `suspect`                  | trusted; `SUSPECT = 1` avoided; `DOUBT = 2` not heard    |
|                                       | since; `SILENT = 4` not since the newest hop to it began |
| robot, `outside`                      | `INSIDE = 0`; `SOON = 1` about to cross; `OUTSIDE = 2`   |
| robot, at others, `raised`            | `RAISED_LOST = 1`; `RAISED_OUT = 2`; 4: its own alarm is |
|                                       | given a tick                                             |
| access, `waiting`                     | 0; 1: a frame waits for its backoff                      |

Events and transitions
======================
Any frame first: what is not sound (`is_sound`) is dropped; `hear` notes its sender. An ack that was
lost is made good by what is heard later, `drop_overheard`, even in the backoff after it (0085).

| frame                                  | to               | action                               |
|----------------------------------------|------------------|--------------------------------------|
| `REQUEST`                              | all              | `on_request`: below                  |
| `RESPONSE`                             | a hop            | `on_upward`: up; at the gateway      |
|                                        |                  | `on_response`                        |
| `TABLE`                                | a hop            | `on_table`, unless `record_packet`   |
|                                        |                  | had it: along its route; ours:       |
|                                        |                  | `take_part`                          |
| `TABLE_ACK`                            | a hop            | `on_upward`: up; at the gateway      |
|                                        |                  | `on_ack`                             |
| `ACTIVATE`                             | all              | `on_activate`: the table that is     |
|                                        |                  | `ready` is in force; `spread`        |
| `GRAPH`                                | all              | `on_graph`: `read_edges`; `spread`;  |
|                                        |                  | whole, last or asked: `tell_parts`   |
| `GRAPH`, to one                        | a hop            | `relay`; ours: `on_guard`: a standby |
|                                        |                  | asks, or with `TABLES` takes a part: |
|                                        |                  | `read_edges`                         |
| `DATA`, flooded                        | all              | `flood_data`; to one `flood_wanted`  |
| `ALARM`, flooded                       | all              | `on_flood`: the monitor takes it,    |
|                                        |                  | others pass it on once an instance,  |
|                                        |                  | nearer ones first; `yield_routed`    |
| ... again, of who is as near           | all              | `spare_copy`: one less of ours       |
| `POSITION`                             | all, the monitor | `on_position`: noted; a witness      |
|                                        |                  | raises the alarm                     |
| `ALARM`                                | the monitor      | `take_alarm`, `take`                 |
| `DATA`, `E2E_ACK`, `ALARM`, `POSITION` | a hop            | ours: `take`, `accept` once; else    |
|                                        |                  | `relay`                              |
| `ACK`                                  | us               | `on_hop_ack`                         |
| `ACK`                                  | others           | `hear_again`: its sender lives       |
| anything else                          |                  | REPORT_UNKEYED                       |

A hop for which there is no room gets no ack, so that another is tried.

| state      | event                           | action                           | next           |
|------------|---------------------------------|----------------------------------|----------------|
| off        | on, `rank` 0, first time        | `on_start`, `lead`: an epoch     | leads          |
|            |                                 | nobody has had                   |                |
| off        | on, else                        | `on_start`                       | unknown        |
| unknown    | `TICK` 2, 4, 8, ...; 1: `rank` 0| `ask_round`: `REQUEST` of `ALL`  |                |
| any other  | a `REQUEST` of `ALL`            | `tell_round`: ours once more     |                |
| a `rank`   | `TICK`, it led, neighbours say  | `on_tick`, `tick`, `lead`        | leads          |
| any        | `REQUEST` that `is_newer`       | `on_request`, `begin`            | follows        |
| a `rank`   | `TICK`, `dead` silent ticks     | `on_tick`, `tick`, `lead`        | leads          |
| a `rank`   | `JOBS`, no sign of life         | `guard`: asks; learns tolerance  |                |
| a `rank`   | the gateway's frames            | `hear_of_gateway`: it lives      |                |
| a `rank`   | ... and all questions in vain   | `guard`, `lead`, `inherit`       | leads          |
| any        | `REQUEST` of another gateway,   | `redirect`: alarms go to it; who |                |
|            | or `lead`                       | led before is `gone`             |                |
| any        | a frame of who is `gone`, or a  | `hear_of_gateway`,               |                |
|            | table that leads to it          | `put_in_force`: it is not        |                |
| any        | `TICK`                          | `on_tick`: `sweep`, `age`,       |                |
|            |                                 | `watch`, `beacon`,               |                |
|            |                                 | `repeat_alarm`                   |                |
| new round  | `REQUEST`, strong               | `queue_request`, `join`          | RESPOND        |
| new round  | `REQUEST`, weak                 | `await_better`                   | LOOK_AGAIN     |
| follows    | `REQUEST` that `is_shorter`     | `queue_request`: we are nearer   |                |
| LOOK_AGAIN | `ROUND`                         | `step`, `look_again`, `join`     | RESPOND        |
| RESPOND    | `ROUND`                         | `step`, `respond`                | NOTHING        |
| new round  | `REQUEST`, `PRIORITY`           | `keep_table`: it is the new      | NOTHING        |
|            |                                 | gateway's; `join`: no response   |                |
| ...        | ... no table of the epoch       | `keep_table`: we have none       | RESPOND        |
|            | before                          |                                  |                |
| new round  | `REQUEST` that names others     | `is_spared`, `join`: no response | NOTHING        |
| IDLE       | `TICK`, the period is over, no  | `start_round`; it waits less     | COLLECTING     |
|            | tables are going out            | than another period for them     |                |
| IDLE       | `RESPONSE`, without a table     | `admit`: its table, or a round   |                |
| COLLECTING | `RESPONSE`                      | `on_response`: `note_list`,      |                |
|            |                                 | unless `WEAK` `note_path`        |                |
| COLLECTING | `ROUND`, with `asks`, some did  | `collect`, `ask_again`: by name  | ASKED          |
|            | not respond                     |                                  |                |
| COLLECTING | `ROUND`, else                   | `collect`: `build_graph`,        | IDLE           |
|            |                                 | `give_jobs`, `pump`              |                |
| ASKED      | `RESPONSE`, `ROUND`             | as while COLLECTING, late ones   | IDLE           |
| CURRENT    | a changed table                 | `give_job`                       | TO_SEND        |
| TO_SEND    | fewer than `jobs` under way     | `pump`, `start_job`,             | UNDER_WAY      |
|            |                                 | `queue_parts`                    |                |
| UNDER_WAY  | `TABLE_ACK`, all parts          | `on_ack`                         | CURRENT        |
| UNDER_WAY  | `JOBS`                          | `retry_jobs`: again, or no more  | ..., GIVEN_UP  |
| ...        | ... a table, `IN_A_ROW` times   | ... once more behind all others  | TO_SEND        |
| GIVEN_UP   | the next round                  | `give_jobs`                      | TO_SEND        |
| FREE       | something to send               | `compose`, `take_over`:          | WAITS          |
|            |                                 | `enqueue`                        |                |
| WAITS      | `TX`, or the one before has     | `kick`, `send_all`: by rank,     | DOWN           |
|            | gone                            | then age                         |                |
| DOWN       | `SENT`                          | `take_sent`, `settle`;           | UNACKED        |
|            |                                 | broadcasts: next copy or done    |                |
| any        | `ACK`; DOWN it goes a last time | `take_ack`, `close`              | FREE           |
| any        | it is heard going on, or came   | `drop_overheard`, `close`        | FREE           |
| UNACKED    | `ACK_WAIT`                      | `on_ack_timeout`: again, up to   | WAITS          |
|            |                                 | `transmissions`                  |                |
| UNACKED    | ... the last of them            | `hop_failed`: `suspect`, `aim`   | WAITS          |
|            |                                 | at another                       |                |
| ...        | ... and nobody is left          | `put_out`                        | FREE           |
| no entry   | `MESSAGE`                       | `on_message`: `buffer_sent`,     | waits          |
|            |                                 | `send_buffered`                  |                |
| waits      | `E2E_ACK`                       | `take`, `on_end_ack`:            | FREE           |
|            |                                 | REPORT_ARRIVED, `pass_over`      |                |
| in vain    | `E2E_ACK` for anybody           | `mark_reachable`: who sent it    | tried again    |
|            |                                 | lives                            |                |
| at its end | `HANDED_UP`, in order           | `on_handed_up`                   | acknowledged   |
| waits      | `RETRY`                         | `on_retry`, `retransmit`;        | waits          |
|            |                                 | alarms: `flood_again`            |                |
| waits      | ... `e2e_tries` more were sent  | REPORT_EXPIRED,                  | FREE           |
|            |                                 | `UNREACHABLE = 254`              |                |
| trusted    | no hop ack                      | `suspect` for `suspect_us`       | SUSPECT, DOUBT |
| SUSPECT    | ... over, `sweep`, or `trust`   | one transmission is enough to    | DOUBT          |
|            |                                 | ask                              |                |
| any        | any frame of it                 | `hear`, `hear_again`             | trusted        |
| INSIDE     | `SAMPLE`, `is_soon`             | `on_sample`, `judge`:            | SOON           |
|            |                                 | `PREDICT = 0`                    |                |
| any        | `SAMPLE`, margin below 0        | `judge`: `CROSS = 1`             | OUTSIDE        |
| OUTSIDE    | `SAMPLE`, `clear_margin` inside | `judge`: `CLEAR = 3`             | INSIDE         |
| OUTSIDE    | `TICK`, monitor has not heard   | `repeat_alarm`: CROSS again      |                |
| monitor    | `TICK`, not heard for `lost`    | `watch`: `LOST = 2`              |                |
| waiting 0  | a packet from above             | `back_off`; urgent: at once      | 1              |
| waiting 1  | `BACKOFF`, channel idle         | it is sent                       | 0              |
| waiting 1  | ... busy `busy_max` times       | REPORT_GAVE_UP                   | 0              |

Timers
======
| timer          | runs                                                                            |
|----------------|---------------------------------------------------------------------------------|
| `TX = 0`       | until the first queued frame is due: floods within `flood_us`, requests         |
|                | `jitter_us`                                                                     |
| `ACK_WAIT = 1` | `ack_us` from SENT on; with `ack_adapt` a round trip to that neighbour longer   |
| `ROUND = 2`    | a node: 2 `jitter_us` to look again; `listen_us` and up to `spread_us` to       |
|                | respond; the gateway: `collect_us`                                              |
| `TICK = 3`     | `tick_us`, by itself: `period`, `period_max`, `dead`, `dead_step`, `forget`,    |
|                | `lost` are counted in it                                                        |
| `RETRY = 4`    | first end-to-end timeout: `e2e_us`, or with `e2e_adapt` 4 round trips; doubled, |
|                | at most 4 times                                                                 |
| `JOBS = 5`     | gateway: a table's acks: `job_us`, more by tries, parts and hops; standby:      |
|                | `guard_us`, so many as stand by before it; before a question more with          |
|                | `tolerance`; after a request of who is new or has no table `collect_us` more    |
| `BACKOFF = 0`  | access: a draw below 2^exponent times `backoff_us`                              |

`TIMERS = 6`, of access `TIMERS = 1`. Exponents: `exponent_min` and a transmission each, at most
`exponent_max`.

Frames
======
| frame           | way                          | payload                                         |
|-----------------|------------------------------|-------------------------------------------------|
| `REQUEST = 1`   | flooded, `copies`            | gateway, epoch, round, version in force, jitter;|
|                 |                              | who is asked by name; flag `PRIORITY`: tables   |
|                 |                              | stay; more copies. Of `ALL`: which round is it? |
| `RESPONSE = 2`  | up                           | epoch, round, reading, who was heard and how    |
|                 |                              | loud; flag `WEAK`: came over a faint link       |
| `TABLE = 3`     | source-routed                | route; epoch, version, part; groups (next,      |
|                 |                              | alternate, recipients)                          |
| `TABLE_ACK = 4` | up                           | epoch, version, parts that are there            |
| `ACTIVATE = 5`  | flooded                      | epoch, version; with `activation` only          |
| `DATA = 8`      | routed or flooded            | the user's, at most `DATA_MAX = 90` bytes; 1163 |
|                 |                              | at an MTU of 1200                               |
| `E2E_ACK = 9`   | routed                       | the number of the packet                        |
| `ALARM = 10`    | routed and flooded           | `ALARM_BYTES = 16`                              |
| `POSITION = 11` | one hop; with `watch` routed | `POSITION_BYTES = 8`; `SAID_OUT = 1`,           |
|                 |                              | `SAID_HEARD = 2`                                |
| `GRAPH = 12`    | flooded; a standby's routed  | epoch, version, part; links as bits, or who is  |
|                 |                              | asked; routed, nothing: a question or an answer |
| `ACK = 16`      | to the hop before            | no common header: `ACK_BYTES = 9`               |

Flags: `ACK_WANTED = 1`, `END_TO_END = 2`, `FLOOD = 4`, to one recipient `ORDERED = 4`,
`SOURCE_ROUTE = 8`, `DETOURED = 16`, `PRIORITY = 32`, `FIRST = 64`, of a response `WEAK = 64`,
`PARITY = 128` (turns over with each retransmission). Addresses: `ALL = 255`, `MONITOR = 254`,
`IDS = 254`, `NOBODY = 255`. Bit by bit: docs/wire.md.

Inputs and reports
==================
Inputs: `MESSAGE = 1`, `SENT = 2` from the layer below, `SAMPLE = 3`, `HANDED_UP = 4` (a message
that was `ORDERED` is acknowledged then, and given to the user as `AGAIN = 13` when it comes again
before); of access `PACKET = 1`.

| report                                    | meaning                                              |
|-------------------------------------------|------------------------------------------------------|
| `REPORT_ACCEPTED = 1`                     | message a goes out as packet b                       |
| `REPORT_HOP = 2`                          | message a was acknowledged by its first hop          |
| `REPORT_ARRIVED = 3`                      | message a was acknowledged end to end                |
| `REPORT_EXPIRED = 4`                      | message a: given up for reason b                     |
| `REPORT_FULL = 5`                         | message a was refused for reason b                   |
| `REPORT_DROPPED = 6`                      | packet (origin a, number b) is given up here         |
| `REPORT_SUSPECT = 7`                      | neighbour a does not answer; b = 1: it was next in   |
|                                           | the table                                            |
| `REPORT_ROUND = 8`                        | gateway: round a of epoch b begins                   |
| `REPORT_GRAPH = 9`                        | gateway: a links; b = 1: others than before          |
| `REPORT_TABLE = 10`                       | table a of epoch b is in force here                  |
| `REPORT_TABLES = 11`                      | gateway: tables of version a are acknowledged, b     |
|                                           | nodes are without                                    |
| `REPORT_GATEWAY = 12`                     | we follow gateway a of epoch b                       |
| `REPORT_ALARM = 13`, `REPORT_MARGIN = 14` | alarm: kind a for robot b; margin a cm, number b     |
| `REPORT_UNKEYED = 15`                     | a packet of unknown type a                           |
| `REPORT_SILENCED = 16`                    | not sent at present                                  |
| `REPORT_GAVE_UP = 1`                      | access: the channel was busy a times                 |

Reasons: `NO_ROUTE = 1`, `NO_ACK = 2`, `PUT_OUT = 3`, `NO_ROOM = 4`. Ranks in the queue:
`ALARMS = 0`, which requests of a gateway and what standbys ask and are told have, too;
`CONTROL = 1`, `MESSAGES = 2`, `OWN = 3`.

Constants and settings
======================
| name                                           | source                                          |
|------------------------------------------------|-------------------------------------------------|
| `PATH_MAX = 24`, `TTL = 48`                    | A9: a path bounds a packet; a search goes back  |
|                                                | over it                                         |
| `HEADER_BYTES = 11`, `CRC_BYTES = 2`,          | [mesh 2]; `mtu` 64 or `MTU = 127`, on IP links  |
| `MTU_MAX = 1200`, `BODY = 114`                 | up to 1200: then records have more room         |
| `NEIGHBOURS = 32`, `QUEUE = 8`, `WAITING = 8`  | memory: 4 KB a node (decision 0015)             |
| `SMALL = 64`                                   | larger networks keep all that they hear         |
| `queue`, `kept`, `PLACES_MAX = 64`             | places of both where memory is no matter        |
| `HOP_FIRST = 4`, `TIMEOUTS = 4`                | frames under way at first; handled in one call  |
| `GATHERED = 16`, `ACK_MORE_BYTES = 3`,         | acks that go together: of hops, end to end      |
| `END_ACKS_BYTES = 24`                          |                                                 |
| `FORWARDED = 64`, `SKIPS = 16`                 | duplicate cache; failed and bad neighbours      |
| `WINDOW_WORDS = 5`, `BITS = 15`, `BITS = 8`    | words of 15 bits: 75 numbers; nodes in a byte   |
| `AHEAD_MAX = 64`                               | numbers: so far ahead of one still tried at most|
| `ANEW = 320`                                   | numbers behind the window: FIRST is a new boot  |
| `TABLES = 0`, `WHOLE_GRAPH = 1`,               | `mode`                                          |
| `TABLE_FREE = 2`                               |                                                 |
| `TREE = 1`, `EACH = 2`, `LIST = 3`             | `discovery`, A1                                 |
| `RANDOM = 0`, `LOUDEST = 1`, `ALTERNATE = 2`,  | `failover`, A6; `avoid_origin` A7, `retry` A4;  |
| `SEARCH = 3`, `recent`, `RSSI_SPAN = 1024`     | by last heard time, then RSSI (decision 0071)   |
| `on_demand`, `CALLS = 2`, `AT_EASE = 6`        | decision 0071: floods; places free to take part |
| `PARTS_MAX = 15`, `PART_HEAD = 4`,             | tables and graphs on the wire                   |
| `GROUP_BYTES = 3`, `TOLD = 32768`              | of a node is known which parts it has (0081)    |
| `ROUNDS_VALID = 3`, `LOW_BITS = 85`            | rounds for which a report of a link counts, two |
|                                                | bits a link; the lower ones of a byte           |
| `SLACK = 2`                                    | ticks: nodes count them from different moments  |
| `guard_us`                                     | decision 0042: a standby's wait; one more for   |
|                                                | each that is before it                          |
| `IN_VAIN = 4`, `TOLERANCE = 40`,               | questions in vain; eighths of one more: at      |
| `TOLERANCE_MAX = 64`                           | first, after a late answer (decision 0067)      |
| `SPARE_HOPS = 3`                               | decision 0053: of a question, beyond the depth  |
| `COUNTED_MAX = 15`, `UPLINKS_TOLD = 3`         | neighbours in a response: counted; table-free   |
| `REQUEST_BYTES = 7`, `ASKED_MAX = 20`          | of a request, before names; most names, for an  |
|                                                | MTU of 64                                       |
| `IN_A_ROW = 3`                                 | tries of a table, before it is the others' turn |
| `PLACES_RESERVED = 3`                          | of the gateway's queue, for what passes through |
| `FAILURES_MAX = 6`, `LAST_TRIES = 4`,          | failed hops at a node, then a packet up tries   |
| `HOPS_MAX = 40`                                | anybody; then it is dropped; a routed one is    |
| `LIVELY_TICKS = 2`                             | heard so lately: a missing ack is the channel's |
| `STRAIN_FREE = 48`, `STRAIN_HEAVY = 112`,      | decision 0016: quarters of acks missing before  |
| `STRAIN_MAX = 176`, `PER_DOUBLING = 16`,       | searches, then messages pause; how fast pauses  |
| `DROWNED_TRIES = 8`                            | double; 0083: tries of a hop, then a search ends|
| `ALL_ACKED = 255`, `RATIO_MIN = 64`,           | shares of transmissions acknowledged: all; the  |
| `POOR_MIN = 32`, `SMOOTHING = 3`,              | least believed, of a loud link, of a faint one; |
| `MISSES_MAX = 31`                              | an eighth of what is new                        |
| `UNIT = 4`, `SPARE = 1428`, `TRIES_MAX = 12`   | an ack in quarters; what it takes back; most    |
|                                                | transmissions because a link is poor            |
| `LONGEST_US = 65536`                           | of a pause before it is doubled                 |
| `LONGEST_US = 1048576`, `DOUBLED_MAX = 2`      | of a hop's round trip; of its wait, doublings   |
| `LONGEST_US = 134217728`,                      | bounds of timeouts, so that sums stay below     |
| `TICK_MAX_US = 4194304`                        | 2^30                                            |
| `LIFETIME_TIMEOUTS = 48`                       | timeouts: how long a message may be tried       |
| `UNTOLD = 2`                                   | decision 0044: doublings more without a table   |
| `SURE_AFTER = 2`                               | tries; after fewer in vain nobody is            |
|                                                | unreachable                                     |
| `SEARCH_BACKOFF_MAX = 3`,                      | who is unreachable is tried again after 4 to 32 |
| `UNREACHABLE_TICKS = 4`                        | ticks                                           |
| `RETRIES = 4`, `LOST_A_TICK = 4`               | in one call, for the outbox has to hold them    |
| `FLOODED = 20`, `WANTED = 21`                  | in the duplicate cache: flooded alarms, messages|
| `CROWD = 32`                                   | nodes whose answers find their way in a         |
|                                                | `spread_us`                                     |
| `JITTER_UNIT_US = 10000`                       | of a request's jitter                           |
| `COPIES_MORE = 4`                              | decision 0049: of the request of who takes over |
| `FAINT_DB = 2`                                 | 0052: a link so much below `min_rssi` is faint  |
| `FOR_WHAT_COMES_DOWN = 3`                      | decision 0073: places, kept where all climbs    |
| `POINTS = 48`, `FAR = 16384`, `REACH = 23170`, | the fence in whole numbers below 2^30           |
| `FULL = 268435456`, `ROOT_BITS = 15`           |                                                 |
| `TIME = 1073741823`, `TICKS_MAX = 32767`       | clocks wrap at 2^30; longest suspicion          |
| `FREE = 255`, `UNHEARD = 255`, `NONE = 255`,   | nobody, nothing, not yet                        |
| `NONE = -1`, `FAR = 255`, `NEVER = 255`        |                                                 |
| `NOBODY_GAVE = 255`, `NO_OWNER = -1`,          | nobody, no message, no pause                    |
| `NO_BACKOFF = -1`, `ANYHOW = 2`                | ... whatever is suspected of a neighbour        |
| `width`, `row`, `places`, `nodes`              | sizes of a capacity class, and of this network  |
| `told`, `hop_acks`                             | the layer below says SENT; hops acknowledge, or |
|                                                | SENT says so                                    |
| `min_rssi`, `faint`, `poor`                    | not reported; A2: best uplink; decision 0068    |
| `reliable`, `standby`, `job_tries`, `asks`     | messages are kept; there is a standby; tries of |
|                                                | a table; who did not respond is asked once more |
| `monitor`, `flood`, `instances`                | A14; when alarms are flooded, and how often     |
| `predict_ms`, `unit_cm`, `points`, `px`, `py`, | the fence [mesh 6]                              |
| `after`, `fence`                               |                                                 |

What holds, and under what assumption
=====================================
Assumed: frames are whole (CRC) and nobody lies; a clock runs steadily; links may be lost, one-way
or gone at any moment, and nodes die and come back without memory.

- A packet visits at most 24 nodes and 48 transmissions of its own: nothing circles for good,
  whatever tables say (A9). With `failover` SEARCH and no loss it finds a way within 24 nodes, if
  there is one; not to a gateway that another one took over from, before it is heard, or is in a
  table, or two rounds have begun.
- A packet is delivered at most once in a boot of its origin: its recipient clears the window when
  the origin was silent for `forget` ticks; by the half of them nothing is retransmitted any more
  (`lifetime`), and what is under way for longer than the other half may come twice.
- REPORT_ARRIVED is said only when the recipient acknowledged; a message without it, REPORT_EXPIRED,
  may have arrived.
- Of gateways that hear each other one stays: the higher epoch, then the lower number. Between parts
  that do not hear each other there is one each.
- A CROSS is raised again every tick until the monitor acknowledged it: it comes as soon as there is
  a way. Without a standby there is no monitor after the gateway's death, unless it is another node.
- Where all frames of a channel are lost for a while, traffic recovers by itself: pauses grow.
- Shown by the checks of every run, and by exploring small networks with losses and deaths
  (docs/verify.md): no packet for ever between two nodes, one gateway in the end.
"""
