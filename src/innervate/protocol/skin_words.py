"""Names and numbers that all parts of the skin's protocol share [skin 2, 3, 5]."""

PORTS = 4
NONE = -1
INFINITY = 255
ONE = 840
LOAD_MAX = 4095

BEACON = 1
DATA = 2
RESTART = 3
COMMAND = 4

EVERYBODY = 65535  # a command's recipient: all cells

RULE_FEASIBLE = 0
RULE_STRICT = 1
RULE_PAPER = 2
RULE_STATIC = 3
RULE_PAPER_LAX = 4

BALANCE_EVEN = 0
BALANCE_PAPER = 1

PERIODIC = 0
TRIGGERED = 1
WAVE = 2

TICK = 0
SOON = 1
TIMERS = 2

MEMORY_LOST = 1  # on_start: a restart; 0 is the first switching on

SAMPLE = 1  # on_input of a cell: its own sensors, as a frame without addresses
GIVE = 2  # on_input of the PC: a command, as a frame with recipient, code and value

REPORT_PARENT = 1  # a old port, b new port
REPORT_BALANCE = 2  # the same, to balance the load
REPORT_BROKEN = 3  # a port, b 1 broken / 0 works again
REPORT_DROP = 4  # a reason
REPORT_FORGET = 5  # fd was forgotten
DROP_NO_ROUTE = 1
DROP_LOOP = 2
DROP_AGAIN = 3  # a command that was here before
DROP_TOO_FAR = 4  # a command that passed more cells than a route can have
