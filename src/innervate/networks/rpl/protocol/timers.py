"""Timers of a node of RPL."""

TRICKLE = 0
ACK_WAIT = 1
DAO_DELAY = 2
TICK = 3
