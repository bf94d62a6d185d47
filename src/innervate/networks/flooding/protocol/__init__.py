"""Managed flooding, after Meshtastic's "Mesh Broadcast Algorithm".

A test holds all names and numbers here against the code; what the document says is held, sentence
by sentence, in `tests/networks/flooding`.

Theory of operation
===================
A node that hears a packet for the first time delivers it if it is for it or for all, waits, the
shorter the fainter it came in, and passes it on with one hop less, unless it hears meanwhile that
another did. Who made a packet takes hearing it again for an acknowledgement; without one it sends
it again, three times at most. Who a packet is for answers with an acknowledgement, which is flooded
alike.

*Left out*: roles (all nodes are clients), next-hop routing of direct messages (since 2.6), channels
and encryption, windows that grow with the use of the channel, a negative acknowledgement as a
packet. A packet that went down to CSMA is not taken back.

`node.py` has the functions, `fields.py` what nodes and frames hold, `sizes.py` how many.

States
======
| machine                     | states                                                            |
|-----------------------------|-------------------------------------------------------------------|
| a place for others' packets | free (`waits` = 0); a packet waits to be passed on                |
| a place for own packets     | free (`open` = 0); not acknowledged, sent again `open_tries` times|
| a packet, to a node         | unknown; known (its origin and id are among the last `SEEN = 64`) |

Events and transitions
======================
| frame        | what is done                                                                     |
|--------------|----------------------------------------------------------------------------------|
| `PACKET = 1` | `remember`; for us or for all: `take`, and `answer` one that was for us alone;   |
|              | else `pass_on`                                                                   |
| `ACK = 2`    | likewise; for us: `take`, `acknowledged`                                         |

| state            | event                                     | action               | next      |
|------------------|-------------------------------------------|----------------------|-----------|
| off              | on, or memory lost                        | `on_start`           | all free  |
| free (own)       | our user has a message                    | `on_input`,`send_own`| open      |
| open             | heard again, or its acknowledgement       | `acknowledged`       | free      |
| open             | not in time                               | `send_own`           | open      |
| open             | not in time, after `retries` more         | `on_timer`: given up | free      |
| free (others')   | an unknown packet with hops left          | `pass_on`            | waits     |
| waits            | another has passed it on (fewer hops)     | `spare`              | free      |
| waits            | its time has come                         | `fill` a frame, send | free      |
| known            | its origin sends it again (all its hops)  | `pass_on`, `answer`  | known     |
| known            | `forget_us`, for the oldest               | `on_timer`           | unknown   |

Timers
======
`TIMERS = 13`: one for each of `PLACES = 8` packets of others, one for each of `OWN = 4` of ours,
and `FORGET = 12`. A packet of others waits 2 `cw_max` slots and some of 2^b, where b (`window`)
grows from `cw_min` at `faint_dbm` to `cw_max` at `loud_dbm`.

Frames
======
Their layouts stand beside this folder. `hops` counts down, `start` is where it began; a packet has
`BODY = 8` numbers of two bytes.

Inputs and reports
==================
`MESSAGE = 1` is a message for `dest`, `EVERYBODY = 255` for all. Reports: `REPORT_ACKED = 1` (id, 1
by its recipient or 0 as it was heard again), `REPORT_GAVE_UP = 2` (id, tries), `REPORT_FULL = 3`
(origin, id; no place was free).

Constants and settings
======================
An answer may go `ANSWER_MORE = 2` hops more than the question went. A call puts at most
`OUTBOX = 12` actions; times are at most `CLOCK = 1073741823`.

| setting     | by itself  | is                                                                    |
|-------------|------------|-----------------------------------------------------------------------|
| `hops`      | 3          | that packets may be passed on                                         |
| `slot_us`   | 320        | of the wait before a packet is passed on                              |
| `cw_min`    | 3          | bits of the window of the faintest                                    |
| `cw_max`    | 8          | of that of the loudest                                                |
| `faint_dbm` | -95        | and fainter counts as faintest                                        |
| `loud_dbm`  | -65        | and louder counts as loudest                                          |
| `retry_us`  | 100,000    | until an own packet is sent again                                     |
| `retries`   | 3          | that it is, at most                                                   |
| `forget_us` | 10,000,000 | from forgetting one packet to the next                                |

What holds, and under what assumption
=====================================
A node keeps a packet once, passes on none of its own, and what waits has fewer hops left than it
began with; so every copy ends. It passes a packet on once unless its origin sends it again, while
it is among the last `SEEN`: nothing else keeps a flood from going round.
"""
