"""Declarations of CSMA: every field once, as (name, length, low, high, unit, meaning).

Columns as in the skin's.
"""

from innervate.dialect.fields import DRAWS

STATION = (
    *DRAWS,
    ("waiting", 0, 0, 1, "flag", "a frame waits for its backoff to end"),
    ("exponent", 0, 0, 15, "bits", "the backoff is one of 2^exponent"),
    ("busy", 0, 0, 255, "times", "the channel was busy when the frame's backoff ended"),
    ("carrier", 0, 0, 1, "flag", "the channel is busy, as told last"),
)

ITEM = (
    ("us", 0, 0, 16777215, "us", "the frame's length on the air"),
    ("urgent", 0, 0, 1, "flag", "goes out at once, whatever the carrier says"),
    ("attempt", 0, 0, 14, "tries", "transmissions of this frame before"),
)

# What an action of a station's outbox has (dialect/outbox.py).
ACTION = (
    ("kind", 0, 0, 15, "kind", "1 SEND, 2 SET_TIMER, 3 DELIVER, 4 REPORT"),
    ("a", 0, 0, 15, "number", "0, timer or code"),
    ("b", 0, 0, 1073741823, "number", "delay, time of the timer or a of the report"),
    ("c", 0, 0, 15, "number", "flags or b of the report"),
)

PARAMS = (
    ("backoff_us", 0, 1, 16777215, "us", "unit of the backoff"),
    ("exponent_min", 0, 0, 15, "bits", "backoff exponent of a first attempt"),
    ("exponent_max", 0, 0, 15, "bits", "most"),
    ("busy_max", 0, 1, 255, "times", "found busy so often, the frame is given up"),
)
