"""What a medium and a protocol say to each other: inputs, and reports that count.

Everywhere a protocol has the same functions: `on_start(state, params, now, cause, out)`,
`on_frame(..., port, frame, out)`, `on_timer(..., timer, out)`, `on_input(..., kind, item, out)`,
and on the air `on_carrier(..., cd, voc, out)`; `now` is the node's own clock modulo 2^30, and what
it wants done it puts into the outbox (see outbox.py). What the media decide stands in
`sim/cables`, `sim/channel` and `sim/field`.
"""

# Inputs over cables; a network may have more.
SAMPLE = 1  # item: what a node's sensors say, once a period of its source
# Inputs on the air.
PACKET = 1  # item: a packet to send (see radio_fields.PACKET)
LEAVE = 2  # finish and send no more
FORCE = 3  # paper mode: a packet to send at once, whatever the carrier says
RESULT = 4  # baselines: item.handle stations received our last packet
CLOCK = 5  # baselines: slot item.handle began item.ago us ago
QUEUE = 16  # packets a station holds; its user keeps the rest
ALL = 65535  # a frame's field `to`, where it is declared: for everybody in reach
# Reports: (code, a, b).
REPORT_DELIVERED = 1  # packet handle a and the b - 1 after it are taken for delivered
REPORT_LEFT = 8  # sends no more and may be switched off
REPORT_GAVE_UP = 1  # a medium access in a field: the channel was busy a times; the frame is back
