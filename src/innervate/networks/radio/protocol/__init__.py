"""The protocol of a radio team: its state machines and what they declare.

[radio] is Kim and Kim, "CSMA/CD-R for a Wireless Multi-robot Communication"; Q1 .. Q17 and F1 .. F5
are our readings (docs/readings.md), T1 .. N2 rules that had to be added. A test holds all names and
numbers here against the code, and that every branch by which a handler hands an event on has its
row.

Theory of operation
===================
CSMA/CD with reservation: stations share one channel and have no centre. Radios are half duplex, so
a sender hears a collision only behind its own packet; those who collided send CR-Rs (one slot of
carrier each), and the CR-Rs order who sends next. Two machines are here.

*Paper mode* (`paper.py`) is the protocol as published. A station whose packet ends first still
hears the others' ends: how long after its own they come, Tc and Tc0, orders the CR-Rs. Whoever
hears n CR-Rs behind its own sends in turn n + 1, who ended last and sent none behind all of them.
Silence for G behind a packet counts as delivery to everybody.

*Practical mode* (`practical.py`) bears any number of stations, unequal delays and slow radios
(decision 0010). Three things differ: who heads a reservation, the *reporter*, listens through all
of it; the order comes from minislots instead of transmission ends; and a packet counts as delivered
only when the station named next says that it received it. Stations with packets keep places in a
round: every data frame names the next place, and between two there is a turnaround and a delay,
nothing else. Windows for newcomers open behind a round. In a window each newcomer sends one CR-R in
a random minislot; the report says which held one. Those are places now; several in one split.
With slow radios a place is kept when the queue is empty. Where few have places each has a turn in
every round, two slots without a packet, until nobody has sent for long (decision 0048); where many
have, too, while turns of several packets are mostly used (decision 0062). Else (decision 0039) such
a place has no turn, and the minislot of its number in each window that no report announced;
newcomers' stand behind those.

`station.py` is what both share; `modes.py`, `times.py`, `bounds.py`, `idle.py`, `turn.py`,
`window.py`, `reporter.py`, `follow.py` belong to practical mode, `paper_idle.py`,
`paper_verify.py`, `paper_reserve.py`, `paper_turns.py` to the paper's. The baselines stand in
`networks/radio/baselines`.

States
======
Practical (`modes.py`); up to `CARRIERS = 4` the radio listens:

| state             | meaning                                                             |
|-------------------|---------------------------------------------------------------------|
| `IDLE = 0`        | in no sequence; opens one when it has a packet and may              |
| `LEAD = 1`        | reporter: listens to the window behind its own frame                |
| `WINDOW = 2`      | a window of somebody else; has perhaps chosen a minislot            |
| `TURN = 3`        | waits for the frame of the station whose turn it is, or for its own |
| `LOST = 4`        | a report was garbled: waits for a clean frame                       |
| `SEND_OPEN = 5`   | deaf: an opening, its packets or a probe                            |
| `SEND_DATA = 6`   | deaf: its turn                                                      |
| `SEND_REPORT = 7` | deaf: its report                                                    |
| `SEND_SLOT = 8`   | deaf: its CR-R or pulse                                             |

Paper (`paper_idle.py`):

| state           | meaning                                                           |
|-----------------|-------------------------------------------------------------------|
| `IDLE = 0`      | step 1: sends when it has a packet and the channel is idle        |
| `JOIN = 1`      | switched on late: a resolution may be under way (Q10)             |
| `TAIL = 2`      | step 4: behind its packet there was a carrier at once             |
| `QUIET = 3`     | step 3: there was none, or it ended too soon to be of a later one |
| `AWAIT = 4`     | step 5: collided, waits for the first CR-R                        |
| `RESERVE = 5`   | step 6: counts CR-Rs until the window closes, and sends its own   |
| `TURNS = 6`     | step 7: counts turns, and takes its own                           |
| `GARBLED = 7`   | N2: a turn could not be read: was it one?                         |
| `SEND_DATA = 8` | deaf: a packet                                                    |
| `SEND_CRR = 9`  | deaf: a CR-R                                                      |

Roles in a resolution: `NOBODY = 0`, `REPORTER = 1` (ended second to last, sends the first CR-R),
`LAST = 2` (sends none), `OTHER = 3` (one after the first), `OUTSIDER = 4` (did not collide). What a
burst of carrier was: `NOTHING = 0`, `REPORTS = 1`, `PACKET_ENDS = 2`, `NOISE = 3`.

Events and transitions
======================
Practical. D, J, G, Wr: see Timers. `enter_turn` leads on to its own turn, to `TURN`, or, with
nobody left, by `finish` to `IDLE`.

| state         | event                         | action                            | next         |
|---------------|-------------------------------|-----------------------------------|--------------|
| off           | on                            | `listen_first`: J of silence, if  | IDLE         |
|               |                               | others may be on                  |              |
| any           | `PACKET`                      | `enqueue`; in IDLE `offered`      |              |
| any           | `LEAVE`                       | `leave`: what is queued, then no  |              |
|               |                               | more                              |              |
| `IDLE`        | `MAIN`, packet and no carrier | `open_now`                        | SEND_OPEN    |
| `IDLE`        | a burst ends: noise           | `heard_noise`: J and a draw; own  |              |
|               |                               | collision: `wait_again`           |              |
| `IDLE`        | a burst ends: a frame         | `schedule`                        |              |
| `SEND_OPEN`   | radio listens: carrier        | `retry`: others collided with us; | IDLE         |
|               |                               | quick radios: probes from now on  |              |
| `SEND_OPEN`   | radio listens: silence        | `await_answers`, `opened`         | LEAD         |
| `LEAD`        | one before `first_answer`     | `retry`: others collided with us  | IDLE         |
| `LEAD`        | `CRR`                         | `hear_slot`: proof; a good        |              |
|               |                               | minislot, if bounds hold          |              |
| `LEAD`        | a burst ends: noise           | `end_burst`: a bad minislot; too  | LEAD or TURN |
|               |                               | long: `overrun`, no report        |              |
| `LEAD`        | `MAIN`, no carrier            | `end_of_window`, `close`: report  | SEND_REPORT  |
|               |                               | what was heard                    |              |
| `LEAD`        | ... a frame was in it         | `close`: `enter_turn`             | TURN, IDLE   |
| `LEAD`        | ... nothing, a pulse was due  | `close`: `retry`, or leave the    | IDLE         |
|               |                               | round for J                       |              |
| `LEAD`        | ... nothing, none was due     | `close`: `enter_turn`, or         | TURN, IDLE   |
|               |                               | `end_sequence`                    |              |
| `SEND_REPORT` | radio listens                 | `sent_report`: next window, or    | LEAD, TURN   |
|               |                               | `enter_turn`                      |              |
| any           | `OPEN`                        | `hear_open`: what was before is   | WINDOW       |
|               |                               | over                              |              |
| any           | `OPEN`, `began_together` with | as noise of that length           |              |
|               | what was heard before         |                                   |              |
| `WINDOW`      | a carrier before it begins    | `lose_opening`: nobody is         | IDLE         |
|               |                               | answered                          |              |
| any           | `DATA`, opens a window        | `hear_data`: `settle`, proof or   | WINDOW       |
|               |                               | not                               |              |
| any           | `DATA`, names a place         | `hear_data`, `enter_turn`         | TURN         |
| any           | `REPORT`                      | `hear_report`: our minislot is a  | WINDOW, TURN |
|               |                               | place, splits or is void          |              |
| `WINDOW`      | `ACT`, no frame on the air    | `use_slot`: our CR-R, or a pulse  | SEND_SLOT    |
| `SEND_SLOT`   | radio listens                 | only the report counts now        | WINDOW       |
| `WINDOW`      | `MAIN`                        | `pass_deadline`: wait for a       | TURN, IDLE   |
|               |                               | report if a carrier came, else on |              |
| `WINDOW`      | a burst ends: long noise      | a garbled report                  | LOST         |
| `WINDOW`      | a burst ends, deadline over   | `enter_turn`                      | TURN         |
| `TURN`        | `ACT`, our own turn           | `send_turn`                       | SEND_DATA    |
| `TURN`        | `MAIN`: D of silence          | `silent_turn`: its place is free; | TURN         |
|               |                               | next                              |              |
| `TURN`        | a burst ends: noise as long   | `garbled_turn`: proves nothing;   | TURN, WINDOW |
|               | as `pass_slots` or longer     | next                              |              |
| `SEND_DATA`   | radio listens: carrier        | `sent_data`: collision, not       | TURN, IDLE   |
|               |                               | delivered                         |              |
| `SEND_DATA`   | radio listens: opened window  | `sent_data`, `lead_first`         | LEAD         |
| `SEND_DATA`   | radio listens: named a place  | `sent_data`, `enter_turn`         | TURN         |
| `LOST`        | a burst ends                  | J anew                            |              |
| `LOST`        | `MAIN`: J of silence          | `listen_first`                    | IDLE         |

Paper:

| state          | event                           | action                          | next        |
|----------------|---------------------------------|---------------------------------|-------------|
| off            | on, together or late            | `on_start`                      | IDLE, JOIN  |
| any            | `PACKET`                        | `enqueue`, `offered`: at once   | SEND_DATA   |
|                |                                 | if idle for F                   |             |
| any            | `FORCE`                         | `enqueue`, `forced`: a test's   | SEND_DATA   |
|                |                                 | wish                            |             |
| any            | `LEAVE`                         | `leave`                         |             |
| `IDLE`         | `MAIN`: idle for F and a draw   | `waited`                        | SEND_DATA   |
| `IDLE`, `JOIN` | CR-Rs                           | `follow`: as `OUTSIDER`         | RESERVE     |
| `IDLE`         | any other burst                 | `wait`: F and a draw anew       |             |
| `JOIN`         | any other burst                 | T and D anew                    |             |
| `JOIN`         | `MAIN`: T and D of silence      | `joined`                        | IDLE        |
| `SEND_DATA`    | radio listens                   | `verify`: carrier or none       | TAIL, QUIET |
| `TAIL`         | one signal is left, or not      | `note_single`: Tc counts to     |             |
|                |                                 | there                           |             |
| `TAIL`         | carrier ends within tau, T1     | `tail_ends`                     | QUIET       |
| `TAIL`         | carrier ends, one signal all    | `tail_ends`: `REPORTER`,        | SEND_CRR    |
|                | along                           | `report_first`                  |             |
| `TAIL`         | carrier ends, several at first  | `tail_ends`: `OTHER`            | AWAIT       |
| `QUIET`        | `MAIN`: G of silence            | `guard_over`: delivered,        | TURNS, IDLE |
|                |                                 | `succeed`                       |             |
| `QUIET`        | CR-Rs                           | `quiet_burst`: collided, `LAST` | RESERVE     |
| `QUIET`        | a packet                        | `quiet_burst`: delivered;       | TURNS, IDLE |
|                |                                 | `missed`                        |             |
| `AWAIT`        | CR-Rs                           | `await_burst`: our own after    | RESERVE     |
|                |                                 | Tc, `ACT`                       |             |
| `AWAIT`        | a packet                        | `await_burst`, `missed`         | TURNS, IDLE |
| `AWAIT`        | `MAIN`: nobody reports          | `substitute`: we do             | SEND_CRR    |
| `RESERVE`      | `ACT`                           | `try_crr`, `send_own`; with a   | SEND_CRR    |
|                |                                 | carrier when it ends            |             |
| `SEND_CRR`     | radio listens                   | `sent_crr`                      | RESERVE     |
| `RESERVE`      | CR-Rs                           | `reserve_burst`: counted        |             |
| `RESERVE`      | a packet or noise as long       | `reserve_burst`: the window is  | TURNS       |
|                |                                 | over                            |             |
| `RESERVE`      | `MAIN`, no carrier              | `window_over`: `enter_turns`    | TURNS       |
| `TURNS`        | a carrier                       | `turn_begins`: who delays its   |             |
|                |                                 | own loses it, T2                |             |
| `TURNS`        | a packet ends                   | `turns_burst`, `turn_over`      | TURNS, IDLE |
| `TURNS`        | `MAIN`: D of silence            | `turn_over`                     | TURNS, IDLE |
| `TURNS`        | CR-Rs                           | `turns_burst`, `nested`, N1: so |             |
|                |                                 | many turns more                 |             |
| `TURNS`        | noise as long as a packet       | `turns_burst`, `garbled`        | GARBLED     |
| `TURNS`        | our turn, or `ACT` behind a     | `take_turn`                     | SEND_DATA   |
|                | delay                           |                                 |             |
| `GARBLED`      | CR-Rs                           | `turns_burst`, `nested`: it had | TURNS       |
|                |                                 | collided                        |             |
| `GARBLED`      | another burst                   | `turns_burst`, `after_garbled`  | TURNS       |
| `GARBLED`      | `MAIN`: G of silence            | `turn_over`                     | TURNS, IDLE |

Timers
======
`MAIN = 0` is the wait or deadline of the present state, void unless `armed`; `ACT = 1` our
minislot, CR-R or delayed turn, void unless `act`. With ta = `ta_us`, delays from `dmin_us` to
`dmax_us` (tau), one slot `slot_us`, a packet T = `packet_slots`:

| wait              | practical                            | paper                                 |
|-------------------|--------------------------------------|---------------------------------------|
| guard G           | `guard`: dmax - 2 dmin - ta, at      | `guard`: 2 tau + ta + `bit_us`        |
|                   | least 0                              |                                       |
| dead turn D       | `turn_timeout`: `dead_us`            | `turn_timeout`: 4 tau + 2 ta          |
| before a packet   | 0                                    | F: 2 tau + 2 ta + a bit; if busy and  |
|                   |                                      | up to `wait_us`                       |
| after a collision | ta, dmax and a draw below Wr:        | T - Tc0, or `window_slots`            |
|                   | `retry_us`, doubled from             |                                       |
|                   | `LONELY_FREE = 3` on; slow radios    |                                       |
|                   | draw one of `STEPS = 6` parts of it  |                                       |
| on switching on   | J: `join_us`                         | T and D                               |
| minislot w        | `minislot_us`: a CR-R, twice the     | -                                     |
|                   | spread of delays                     |                                       |
| opening u         | `probe_us`: two that collide begin   | -                                     |
|                   | within it at every station; slow     |                                       |
|                   | radios are silent behind a packet    |                                       |
|                   | (`silence_behind`), until `apart`    |                                       |

Once delays outside the bounds were noticed (`bounds.py`) they follow from wider ones: `times.py`.

Frames
======
| frame        | length                           | what it carries                                |
|--------------|----------------------------------|------------------------------------------------|
| `CRR = 1`    | one slot                         | nothing: a CR-R, or a pulse that says "heard"  |
| `DATA = 2`   | its packets, or `pass_slots`: 3, | `pos`, `next`, `more`, `ok`, and up to         |
|              | 2 with slow radios               | `per_turn` packets                             |
| `OPEN = 3`   | u or its packets; slow radios:   | as data; how wide the bounds are. `pos`:       |
|              | its packets, u if it has none    | `UNKNOWN = 31`: all places are free again      |
| `REPORT = 4` | `REPORT_SLOTS = 5` and more      | `good`, `bad` minislots, `kept` ones ahead,    |
|              |                                  | `base`; `window`, `span`, `split`              |

In `next`: a place; its own: a window of one minislot; `ALONE = 127`: one, nobody else has a turn;
`WINDOWS = 120` and the `SIZES = 3` from there: 6, 11 or 21 minislots, with quick radios 3, 6 or 12;
`LONE_WINDOWS = 123`: those, and nobody else has a turn; `NEXT_NONE = 126` is not used. Bit by bit:
docs/wire.md.

Inputs and reports
==================
Inputs and the reports `REPORT_DELIVERED`, `REPORT_LEFT` are those of every access protocol:
dialect/access.py.

| report                 | meaning                                                                 |
|------------------------|-------------------------------------------------------------------------|
| `REPORT_FAILED = 2`    | packet a is not delivered: `NO_PROOF = 1`, `HEARD_TAIL = 2`,            |
|                        | `NOT_HEARD = 3`                                                         |
| `REPORT_COLLISION = 3` | own transmission collided; a = 1 in a turn (paper)                      |
| `REPORT_TURN = 4`      | own turn begins: place a (practical), turn a of b (paper)               |
| `REPORT_ROLE = 5`      | role a (paper)                                                          |
| `REPORT_BOUNDS = 6`    | a delay of a us is outside the bounds; b, which: `EARLY = 0`,           |
|                        | `LATE = 1`, `TRIP = 2`, `BEHIND = 3`, `TOGETHER = 4` (`bounds.py`)      |
| `REPORT_DROPPED = 7`   | packet a was offered to a full queue                                    |
| `REPORT_SKIPPED = 9`   | own place was passed over                                               |
| `REPORT_COUNT = 10`    | the window closes: a CR-Rs behind our own, b in all (paper)             |
| `REPORT_STOPPED = 11`  | own transmission is broken off (full duplex, baselines)                 |
| `REPORT_WIDER = 12`    | delays up to a us are believed; b = 1: somebody else said so            |

Constants and settings
======================
| name                                         | source                                            |
|----------------------------------------------|---------------------------------------------------|
| `POSITIONS = 120`                            | places in a round: what 7 bits leave beside the   |
|                                              | codes above                                       |
| `MINISLOTS = 32`                             | in a window: two bits each must fit into a        |
|                                              | report; `NONE = -1` none chosen                   |
| `WIDE_MOST = 3`                              | doublings of dmax that stations go to by          |
|                                              | themselves; `LONGEST_US = 268435455`              |
| `TURNS_MOST = 4095`, `TURNS_COUNTED = 65535` | counters stop there                               |
| `turns`                                      | K: turns between windows, two more for each kept  |
|                                              | minislot; sooner if `CROWD_WAITS = 4` quarters    |
|                                              | of a station wait. Slow radios, newcomers only:   |
|                                              | a round, doubled by each window that nobody came  |
|                                              | to (`CALM_MOST = 7`), up to `RAREST = 4` K        |
| `CROWD_MOST = 1023`                          | bound of that estimate                            |
| `CREDIT = 2`, `CREDIT_MOST = 4`              | quick radios: turns without a packet that one     |
|                                              | with a packet earns                               |
| `EARNED = 48`, `EARNED_MOST = 1600`          | slow radios: of a packet; an own turn without one |
|                                              | costs the square of the places. With none left    |
|                                              | turns are not handed on                           |
| `ASKING_SLOTS = 7`                           | length of a report for few kept places, which     |
|                                              | `is_few` reckons with                             |
| `CALM = 2`                                   | windows without newcomers: all who send have      |
|                                              | places, and if `is_few` the round goes on         |
| `WORTH = 30`, `FLOWING = 500`,               | slots that packets are worth, less turns and      |
| `FLOW_MOST = 1000`                           | windows: from `FLOWING` on, with `CALM_MOST`, the |
|                                              | round of many goes on, too (decision 0062)        |
| `KEPT = 20`                                  | places that can be kept: one less than the        |
|                                              | minislots of the largest window                   |
| `ACTIVE = 1`, `QUIET = 2`, `QUIET_MOST = 99` | of a place: it has turns; it is kept, one more    |
|                                              | with each window, and free behind the last        |
| `BUSY = 10`, `BUSY_MOST = 15`                | windows in which somebody asked, doubled, less    |
|                                              | others: below `BUSY` an opening frees all places  |
| `FAILS_MOST = 3`                             | packets without proof, then the round is left     |
| `LONELY_MOST = 5`                            | doublings of Wr while nobody is heard             |
| `DOUBTED = 2`                                | `heard` of a reporter: noise as long as a frame,  |
|                                              | CR-Rs behind it prove nothing                     |
| `LONELY_NOTICE = 3`, `LONELY_LONG = 8`       | failed openings before noise counts as wrong      |
|                                              | bounds; before noise of two minislots does        |
| `FIRST_SPAN = 6`, `GROWTH = 4`,              | a window that was too small is drawn anew         |
| `PROBE_WINDOW = 6`, `SPAN_MOST = 1023`       | (`plan_window`): 2.3 minislots a station by       |
|                                              | splitting, 2.7 by drawing                         |
| `TRIP_MOST = 1048576`                        | us; longer hand-overs are clocks that wrapped     |
| `RECOLLISIONS = 8`, `DELAY_SLOTS = 8`,       | T2, N1: delays of turns that collided             |
| `NESTED_SLOTS = 64`                          |                                                   |
| `tail_rule`, `overlap_rule`, `dilate`        | T1, T4, CR-Rs stretched over the window: [radio   |
|                                              | 4]                                                |
| the others                                   | the baselines': `mac`, `stations`, `oracle`,      |
|                                              | `full_duplex`, `period_us`, `gap_us`,             |
|                                              | `answer_us`, `backoff_us`, `cw_min`, `cw_max`,    |
|                                              | `p_q15`                                           |

What holds, and under what assumption
=====================================
Assumed of both: everybody hears everybody, and a frame is received where it was alone and the radio
listened. Of practical mode: delays lie in the bounds, and dmax is at most 2 dmin and less than half
a slot above it; at most 120 stations.

- Practical: turns do not collide, and REPORT_DELIVERED is said of a packet only if the station
  named next, or one that sent a CR-R or pulse behind it, received it. A proof that is lost makes it
  go again: receivers may get a packet twice. Others may have missed it (frame errors): nobody is
  told.
- Practical, bounds wrong: noticed where a CR-R or a hand-over can be measured, then widened up to
  `WIDE_MOST` times, and told to the others; slower, and it completes.
- Practical, a station dies: its turn passes after D; who is passed over contends again.
- Practical, two stations believe in one kept place: both ask in its minislot, which is noise, and
  both contend as newcomers; or one asks, and the other sees that in the report and gives it up.
- Paper: with packets of one length all that collide start within tau of each other, so that CR-Rs
  of a third and later station overlap: a reservation orders four stations at most (F1). Silence is
  taken for delivery: a dead reporter or a slow radio loses packets silently (Q9, F2).
- Hidden pairs are outside the assumptions of either: packets may be lost silently (Q11).
- Shown by exploring grids of starts and delays, and the tree of draws (docs/verify.md).
"""
