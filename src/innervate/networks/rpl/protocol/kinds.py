"""Kinds of frames of RPL."""

DIO = 1
DIS = 2
DAO = 3  # storing mode: to a parent
ACK = 4  # of a hop
DATA = 5  # without a source route, and with a short or a long one: so many more
DAO_ACK = 8  # likewise
DAO_UP = 11  # non-storing mode: to the root
ROUTE_ERROR = 12  # non-storing mode: a source route is broken, to the root
