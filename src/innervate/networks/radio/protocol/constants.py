"""Words that all stations of a shared radio channel use: frames, timers, inputs, reports."""

# Kinds of frames.
CRR = 1  # collision report with reservation, or a pulse that says "heard": one slot, no content
DATA = 2  # a packet, or several of one turn
OPEN = 3  # practical mode: begins a sequence; a probe, or the first packet
REPORT = 4  # practical mode: which minislots were good, what follows


# Timers.
MAIN = 0
ACT = 1

POSITIONS = 120  # places in a round of turns; what 7 bits of a header leave
MINISLOTS = 32  # in one window; two bits for each must fit into a report
KEPT = 20  # places kept while there is nothing to send; in the largest window one more is left
NONE = -1
ALONE = 127  # in `next`: nobody else has a turn
UNKNOWN = 31  # place of an opener that knows of no free one: all places are free again
WINDOWS = 120  # in `next`: a window of several minislots follows, then the next place's turn
LONE_WINDOWS = 123  # ... and nobody else has a place; up to 125
NEXT_NONE = 126  # in `next`: not used
WIDE_MOST = 3  # doublings of the greatest delay that stations go to by themselves
TURNS_MOST = 4095  # paper mode: more turns or CR-Rs than that are not counted

REPORT_FAILED = 2  # packet handle a was sent and is not delivered, for reason b
REPORT_COLLISION = 3  # own transmission collided; a = 1: in a turn (paper)
REPORT_TURN = 4  # own turn begins: position a (practical), turn a of b (paper)
REPORT_ROLE = 5  # after a collision: role a (paper)
REPORT_BOUNDS = 6  # a pair delay of a us lies outside the configured bounds; b = which bound
REPORT_DROPPED = 7  # packet handle a was offered to a full queue
REPORT_SKIPPED = 9  # own place in the round was passed over

REPORT_COUNT = 10  # the window closes: a CR-Rs behind our own, b in all (paper)
REPORT_STOPPED = 11  # own transmission is broken off here (full duplex)
REPORT_WIDER = 12  # delays up to a us are believed from now on; b = 1: somebody else said so

# Roles of REPORT_ROLE.
NOBODY = 0  # in no resolution
REPORTER = 1  # ended second to last: sends the first CR-R
LAST = 2  # ended last: sends none
OTHER = 3  # ended before them: sends one after the first
OUTSIDER = 4  # did not collide: follows the turns and has none

# Reasons of REPORT_FAILED.
NO_PROOF = 1
HEARD_TAIL = 2
NOT_HEARD = 3
