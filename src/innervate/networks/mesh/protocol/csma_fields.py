"""Declarations of CSMA: every field once, as (name, length, low, high, unit, meaning).

Columns as in the skin's.
"""

STATION = (
    ("rng", 0, 1, 1073741823, "state", "generator of random choices"),
    ("choice", 0, -1, 1073741823, "value", "what the next draw shall return; -1 = generate"),
    ("asked", 0, 0, 1073741823, "count", "out of how many the last scripted draw was"),
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

PARAMS = (
    ("backoff_us", 0, 1, 16777215, "us", "unit of the backoff"),
    ("exponent_min", 0, 0, 15, "bits", "backoff exponent of a first attempt"),
    ("exponent_max", 0, 0, 15, "bits", "most"),
    ("busy_max", 0, 1, 255, "times", "found busy so often, the frame is given up"),
)
