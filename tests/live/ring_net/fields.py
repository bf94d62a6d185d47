"""Declarations of a token ring, as (name, length, low, high, unit, meaning)."""

FRAME = (
    ("kind", 0, 0, 15, "type", "1 token"),
    ("lap", 0, 0, 65535, "number", "how often it has gone round"),
    ("load", 0, 0, 255, "raw", "what it carries"),
)
STATE = (
    ("number", 0, 0, 65535, "node", "who we are; 0 makes the token"),
    ("lap", 0, 0, 65535, "number", "of the newest token"),
    ("passed", 0, 0, 65535, "tokens", "that we handed on, modulo 65536"),
    ("load", 0, 0, 255, "raw", "what the next token carries"),
)
PARAMS = (
    ("hold_us", 0, 1, 1_000_000, "us", "for how long a token is kept"),
    ("lost_us", 0, 1, 10_000_000, "us", "without a token for so long, node 0 makes another"),
    ("silent_us", 0, 1, 60_000_000, "us", "a cable without a frame for so long is broken"),
)
