"""Declarations of a token ring, as (name, length, low, high, unit, meaning)."""

from innervate.dialect.fields import clock, number

FRAME = (
    ("kind", 0, 0, 15, "type", "1 token"),
    ("lap", 0, *number, "how often it has gone round"),
    ("load", 2, 0, 255, "raw", "what it carries"),
    ("made_at", 0, *clock, "when its load was handed in: a run's own, not sent"),
)
STATE = (
    ("number", 0, 0, 65535, "node", "who we are; 0 makes the token"),
    ("lap", 0, *number, "of the newest token"),
    ("passed", 0, 0, 200, "tokens", "that we handed on; no more than 200 are expected"),
    ("load", 2, 0, 255, "raw", "what the next token carries"),
    ("made_at", 0, *clock, "when we were handed it"),
)
PARAMS = (
    ("hold_us", 0, 1, 1_000_000, "us", "for how long a token is kept"),
    ("lost_us", 0, 1, 10_000_000, "us", "without a token for so long, node 0 makes another"),
)
