"""A protocol as C for microcontrollers: one `.c` and one `.h`, made from the same source."""
