"""What fields of many networks hold, as (low, high, unit), and the fields of whoever draws."""

from innervate.dialect.arith import MASK30

flag = (0, 1, "flag")
number = (0, 65535, "number")
clock = (0, MASK30, "us")
DRAWS = (
    ("rng", 0, 1, MASK30, "state", "generator of random choices"),
    ("choice", 0, -1, MASK30, "value", "what the next draw shall return; -1 = generate"),
    ("asked", 0, 0, MASK30, "count", "out of how many the last scripted draw was"),
)
