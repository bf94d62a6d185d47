"""The protocol of a skin: its state machines and what they declare.

[skin] is Bader, Bergner and Cheng, "A Robust and Efficient Dynamic Network Protocol for a
large-scale artificial robotic skin"; E1 .. E34 and F1 .. F3 are our readings (docs/readings.md).
A test holds all names and numbers against the code, and that every branch by which a handler hands
an event on has its row.

Theory of operation
===================
A distance-vector protocol towards one destination, the PC [skin II-B]. Every period T_b a cell
sends a beacon on each port: its hops to the PC, the sequence number of its route, how many cells'
data leave through it, how many the PC's port serves, and whether the neighbour on this port is its
parent. The PC starts every route with distance 0 and counts the number up every M periods. A cell
takes a nearest port as parent, of several one at random; data go there, hop by hop, and are
neither acknowledged nor repeated. Commands go the other way, over all children, each once.

Links are supervised by absence: a period without a beacon raises the port's penalty, one with a
beacon lowers it; from 1 on the port is broken [skin II-B.3]. Which port may become the parent is
the `rule`; with `RULE_FEASIBLE` it is that of DUAL and Babel (RFC 8966, 2.4): a route newer, or as
new and nearer, than the best that this cell ever announced, its feasible distance fd. With
`updates` beyond `PERIODIC` a changed route is announced at once, `gap_us` apart; `WAVE` passes
newer numbers on as well. Cells with two equally near ports now and then move to the one whose
interface port serves fewer cells [skin II-B.4].

`cell.py` is the cell, `route.py` its choice of a parent, `command_window.py` its duplicate cache,
`sink.py` the PC; `static.py` is the baseline of [skin I-A], a tree that only restarts as a whole.

States
======
| state       | is                        | meaning                                                |
|-------------|---------------------------|--------------------------------------------------------|
| waiting     | `wait` > 0                | restarted: takes no parent until its former children   |
|             |                           | have given it up; drops data, hands commands down      |
| searching   | `wait` = 0, no parent     | takes the first port that is usable and allowed        |
| routed      | `parent` is a port        | forwards; announces its distance and number            |
| port works  | `pf` < `ONE = 840`        | may lead to the parent or to a child                   |
| port broken | `pf` >= `ONE`             | still sends beacons; what waits in its queue is lost   |
| PC listens  | `listen` > 0              | k periods: learns the newest number still around       |
| PC serves   | `listen` = 0              | a beacon on every port each period                     |
| PC repairs  | `repair` = 1, static rule | the network is down for `restart_us`                   |

`parent` = `NONE = -1` is no parent, `dist` = `INFINITY = 255` no route. Fields: `fields.py`.

Events and transitions
======================
A cell, all rules but static (`cell.py`):

| state       | event                     | action                                     | next      |
|-------------|---------------------------|--------------------------------------------|-----------|
| off         | on, first time            | `on_start`: all ports at INFINITY          | searching |
| off         | on, `MEMORY_LOST = 1`     | ... and `wait` = k + 3 + k/8 periods       | waiting   |
| any         | `TICK`                    | `tick`: `supervise`, `select`, `announce`  |           |
| waiting     | ... `wait` is over        | `hold_feasible` counts it down             | searching |
| searching   | ... `hold_periods` passed | `hold_feasible`: fd, number forgotten      | searching |
| searching   | ... a port is allowed     | `select`: `pick` one of the nearest        | routed    |
| routed      | ... parent unusable       | `select`: another allowed port             | routed    |
| routed      | ... and none is allowed   | `select`: announces INFINITY               | searching |
| routed      | ... a nearer port allowed | `select`: `pick`; E9, E10                  | routed    |
| routed      | ... balancing is due      | `is_worth_moving`: to a lighter port       | routed    |
| any         | `BEACON`                  | `hear`: stored; that is all if `PERIODIC`  |           |
| not waiting | `BEACON`, else            | `hear`, `react`: as for TICK;              |           |
|             |                           | `announce_soon`                            |           |
| routed      | `DATA`                    | `forward` to the parent                    |           |
| no parent   | `DATA`, `SAMPLE`          | `forward`: dropped, DROP_NO_ROUTE          |           |
| routed      | `SAMPLE`                  | `on_input`: a data frame to the parent     |           |
| any         | `COMMAND`, new            | `hand_down`: deliver, pass to children     |           |
| any         | `COMMAND`, was here       | `accept_command` says no: dropped          |           |
| any         | `SOON`                    | `announce`, if it still `is_news`          |           |
| port works  | `TICK`, no beacon came    | `supervise`: `pf` + `r_f`, at most 2       | broken: 1 |
| port broken | `TICK`, a beacon came     | `supervise`: `pf` - `r_r`, at least 0      | works: <1 |

A port is usable (`is_usable`) if it works, its neighbour is nearer than `max_depth` and does not
call us its parent. It is allowed (`is_allowed`) by the rule, or while we know no number at all:

| rule                 | allowed is a port whose number, and distance, as last heard           |
|----------------------|-----------------------------------------------------------------------|
| `RULE_FEASIBLE = 0`  | newer than fd's, or equal and strictly nearer (F2)                    |
| `RULE_STRICT = 1`    | newer than that of our present or last route (F1)                     |
| `RULE_PAPER = 2`     | not older than the parent's; without one, than our last route's (E25) |
| `RULE_STATIC = 3`    | -, see below                                                          |
| `RULE_PAPER_LAX = 4` | not older than that of our present or last route                      |

fd changes in `adopt`, to what is nearer (newer, or as new and nearer), never back; only
`hold_feasible` and a restart forget it.

The PC (`sink.py`):

| state   | event    | action                                             | next    |
|---------|----------|----------------------------------------------------|---------|
| off     | on       | `on_start`: `listen` = k                           | listens |
| any     | `BEACON` | `on_frame`: load of the port; takes a newer number |         |
| any     | `DATA`   | `on_frame`: delivered                              |         |
| listens | `TICK`   | one period less, no beacon                         | serves  |
| serves  | `TICK`   | `announce`; every `seq_every` a new number         |         |
| any     | `GIVE`   | `on_input`: a COMMAND to every port with children  |         |

The baseline, `RULE_STATIC` (`static.py`):

| state      | event                   | action                                 | next      |
|------------|-------------------------|----------------------------------------|-----------|
| any        | `BEACON`, newer number  | `join`: parent; passed on by `SOON`    | routed    |
| any        | `SOON`                  | `send_beacons`: the set-up goes on     |           |
| routed     | `RESTART` of our set-up | `give_up`, `flood_restart`             | searching |
| routed     | `TICK`, parent broken   | `give_up`, `flood_restart`             | searching |
| searching  | `TICK`                  | `flood_restart`                        |           |
| any        | `COMMAND`, `DATA`       | `hand_down`, `forward`                 |           |
| PC serves  | `RESTART` of its set-up | `sink_frame`: dead time begins         | repairs   |
| PC repairs | `SOON`                  | `sink_timer`: `announce`, a new number | serves    |

Timers
======
| timer      | set                            | runs                                 |
|------------|--------------------------------|--------------------------------------|
| `TICK = 0` | by itself; clocks run freely   | `beacon_us`, T_b                     |
| `SOON = 1` | a beacon within GAP of another | `gap_us` after the last beacon       |
| ... static | a set-up frame goes on         | `forward_min_us` .. `forward_max_us` |
| ... static | a restart has come to the PC   | `restart_us`                         |

`TIMERS = 2`. In ticks: `k`, `seq_every`, `balance_periods` (drawn anew after a move, E14),
`hold_periods`. With `WAVE` a tick within `skip_us` of the last beacon stays silent.

Frames
======
| frame         | bytes | what it carries, and what it is compared with                        |
|---------------|-------|----------------------------------------------------------------------|
| `BEACON = 1`  | 9     | distance, number (16 bits, RFC 1982), load L (Eq. 1), size S, flag   |
| `DATA = 2`    | 20    | a sample of a cell; `hops` ends it at `max_depth`, DROP_LOOP         |
| `RESTART = 3` | 9     | static: the number of the set-up that is over                        |
| `COMMAND = 4` | 11    | recipient or `EVERYBODY = 65535`, code, value, number of the command |

Beacons are sent URGENT, ahead of the queue. Bit by bit: docs/wire.md.

Inputs and reports
==================
| name                 | meaning                                                                   |
|----------------------|---------------------------------------------------------------------------|
| `SAMPLE = 1`         | to a cell: its sensors were read                                          |
| `GIVE = 2`           | to the PC: a command                                                      |
| `REPORT_PARENT = 1`  | a old port, b new port                                                    |
| `REPORT_BALANCE = 2` | the same, to balance                                                      |
| `REPORT_BROKEN = 3`  | port a broke (b = 1) or works again (0)                                   |
| `REPORT_DROP = 4`    | a: `DROP_NO_ROUTE = 1`, `DROP_LOOP = 2`, `DROP_AGAIN = 3` (a command that |
|                      | was here), `DROP_TOO_FAR = 4` (a command after `max_depth` hops)          |
| `REPORT_FORGET = 5`  | fd was forgotten                                                          |

Constants and settings
======================
| name                | source                                                             |
|---------------------|--------------------------------------------------------------------|
| `PORTS = 4`         | [skin I]: four ports a cell                                        |
| `ONE`               | unit of penalties, divisible by 1 .. 8, so that r_f = 1/k is exact |
| `r_f`, `r_r`, `k`   | [skin II-B.3], E16 .. E19; r_f = r_r = 1/k unless chosen           |
| `LOAD_MAX = 4095`   | 12 bits of a beacon; loads saturate                                |
| `INFINITY`          | E33; `max_depth` is 64 unless chosen                               |
| `WINDOW = 24`       | commands told apart; the newest and 23 behind it                   |
| `seq_every`         | M, F3: min(k, 5)                                                   |
| `balance_periods`   | n_bal, E14: 8 times the depth                                      |
| `balance_rule`      | `BALANCE_EVEN = 0`: E12; `BALANCE_PAPER = 1`: Alg. 3 as printed    |
| `updates`           | `PERIODIC = 0`: [skin Alg. 1]; `TRIGGERED = 1`, `WAVE = 2`: ours   |
| `rule`              | above                                                              |
| k + 3 + k/8 periods | neighbours' clocks up to 5 % slower than ours (decision 0008)      |

What holds, and under what assumption
=====================================
- `RULE_FEASIBLE`: parents never close a ring. What a neighbour announces is never better than its
  own fd, and that only gets better; whoever adopts it has an fd that is worse by a hop. So fd of a
  cell is strictly worse than its parent's, all the way (`invariants.is_worse`). Assumed: a cable
  keeps the order of its frames, and who forgets its fd takes no parent before its children have
  given it up: after a restart by `wait`, after `hold_periods` by the INFINITY it announced.
- `RULE_STRICT`: the same, as long as the PC's number never goes back.
- `RULE_PAPER`, `RULE_PAPER_LAX`: rings are possible while a failure is being noticed (E25); data in
  one end at `max_depth`.
- A broken cable is noticed after `k` periods without a beacon, k - 1 to k + 1 with free-running
  clocks (E21); the new route comes by a newer number, which spreads a hop in a period, with `WAVE`
  in a frame's latency.
- Data of a cell come in order while routes stand, and at most once; nothing is retransmitted: what
  is lost at a failure is lost. A command reaches everybody whose way stands while it goes down.
- Shown by the checks of every run, and by exploring every interleaving of up to three cells
  (docs/verify.md); the rule feasible is proved for any number (docs/prove.md).
"""
