"""Declarations of the skin: every field once, as (name, length, low, high, unit, meaning).

length 0 is a single integer, a number n an array of n, "ports" an array as long as the node has
ports. Record types, plain classes, range checks, trace columns and the docs' tables come from here.
"""

from innervate.dialect.fields import DRAWS, clock, flag, number

FRAME = (
    ("kind", 0, 0, 15, "type", "1 beacon, 2 data, 3 restart (static rule only), 4 command"),
    ("dist", 0, 0, 255, "hops", "beacon: to the PC; 0 the PC, 255 no route; command: its code"),
    ("sq", 0, *number, "beacon: of the sender's route; command: counts the PC's"),
    ("load", 0, 0, 4095, "cells", "beacon: cells whose data leave through it; 0 never had a route"),
    ("size", 0, 0, 4095, "cells", "beacon: load of the interface port that serves the sender"),
    ("parent", 0, *flag, "beacon: 1 = you, on this cable, are my parent"),
    ("cell", 0, 0, 65535, "cell", "data: who measured it; command: who it is for, 65535 all"),
    ("seq", 0, 0, 255, "number", "data: counts the cell's samples"),
    ("hops", 0, 0, 255, "hops", "data, command: cells that forwarded it so far"),
    ("proximity", 0, 0, 65535, "raw", "data: nearness of an object, 0 far; command: its value"),
    ("force", 3, 0, 65535, "mN", "data: three force sensors"),
    ("temperature", 0, -128, 127, "0.5 degC", "data: from 20 degC"),
    ("accel", 3, -512, 511, "raw", "data: acceleration along x, y, z"),
    ("made_at", 0, *clock, "when it was measured, or given: a run's own, not sent"),
)

# Fields of a frame that only a simulation fills in, for its tables: not sent, not on boards.
NOTED = frozenset({"made_at"})

# What an action of a cell's outbox has (dialect/outbox.py).
ACTION = (
    ("kind", 0, 0, 15, "kind", "1 SEND, 2 SET_TIMER, 3 DELIVER, 4 REPORT"),
    ("a", 0, 0, 15, "number", "port, timer, kind of frame or code"),
    ("b", 0, -1, 1073741823, "number", "delay, time of the timer or a of the report"),
    ("c", 0, -1, 15, "number", "flags or b of the report"),
)

CELL = (
    ("dist", 4, 0, 255, "hops", "per port: distance last heard"),
    ("sq", 4, *number, "per port: sequence number last heard"),
    ("load", 4, 0, 4095, "cells", "per port: load last heard"),
    ("size", 4, 0, 4095, "cells", "per port: subnetwork size last heard"),
    ("child", 4, *flag, "per port: the neighbour says that we are its parent"),
    ("heard", 4, *flag, "per port: a beacon came since our last tick"),
    ("pf", 4, 0, 1680, "1/840", "per port: failure penalty p_f; broken from 840 on"),
    ("parent", 0, -1, 3, "port", "our way to the PC; -1 none"),
    ("sq_known", 0, *flag, "sq_own says something: we have had a route"),
    ("sq_own", 0, *number, "sequence number of our present or last route"),
    ("fd_known", 0, *flag, "fd is set"),
    ("fd_sq", 0, *number, "feasible distance: sequence number"),
    ("fd_dist", 0, 0, 255, "hops", "feasible distance: hops"),
    ("own_load", 0, 1, 4095, "cells", "L: cells whose data leave through us, ourselves included"),
    ("countdown", 0, 0, 65535, "periods", "until we may balance again"),
    ("hold", 0, 0, 65535, "periods", "since we lost the route"),
    ("sent_dist", 0, -1, 255, "hops", "distance we last sent; -1 nothing yet"),
    ("sent_parent", 0, -1, 3, "port", "parent we last sent"),
    ("sent_sq", 0, *number, "sequence number we last sent"),
    ("sent_at", 0, *clock, "when we last sent"),
    ("soon", 0, *flag, "the send-soon timer is set"),
    ("tick_at", 0, *clock, "when the next tick is due"),
    ("number", 0, 0, 65535, "cell", "who we are, in our data frames"),
    ("seq", 0, 0, 255, "number", "counts our samples"),
    *DRAWS,
    ("wait", 0, 0, 1023, "periods", "after a restart, until we may take a parent"),
    ("last_command", 0, *number, "the newest command that came"),
    ("commands", 0, 0, 16777215, "bits", "of it and the 23 before it: 1 = that one came; 0 none"),
)

SINK = (
    ("ports", 0, 0, 1048576, "ports", "interface ports of the PC"),
    ("sq", 0, *number, "sequence number of all routes"),
    ("sq_known", 0, *flag, "sq was sent or adopted since the start"),
    ("periods", 0, 0, 65535, "periods", "since sq was last counted up"),
    ("listen", 0, 0, 65535, "periods", "left to listen before the first beacon"),
    ("tick_at", 0, *clock, "when the next tick is due"),
    ("command", 0, *number, "the newest command that was given"),
    ("repair", 0, *flag, "static rule: the network is down for a restart"),
)

SINK_PORT = (
    ("size", "ports", 0, 4095, "cells", "per port: load of the cell on it, if we are its parent"),
)

PARAMS = (
    ("rule", 0, 0, 4, "choice", "0 feasible, 1 strict, 2 paper, 3 static, 4 paper-lax"),
    ("updates", 0, 0, 2, "choice", "0 periodic, 1 triggered, 2 wave"),
    ("beacon_us", 0, 100, 1000000, "us", "period T_b of beacons"),
    ("r_f", 0, 1, 1680, "1/840", "penalty of a period without a beacon"),
    ("r_r", 0, 1, 1680, "1/840", "relief of a period with a beacon"),
    ("k", 0, 1, 840, "periods", "missed beacons until a port is broken"),
    ("max_depth", 0, 1, 254, "hops", "MAXD: longer routes are refused"),
    ("seq_every", 0, 1, 255, "periods", "M: the PC counts sq up every M periods"),
    ("balance_periods", 0, 0, 65535, "periods", "between attempts to balance; 0 = never"),
    ("balance_rule", 0, 0, 1, "choice", "who moves: 0 to even loads out, 1 as Alg. 3 is printed"),
    ("hold_periods", 0, 1, 65535, "periods", "FD_HOLD: without a route until fd is forgotten"),
    ("gap_us", 0, 0, 1000000, "us", "GAP: least time between triggered beacons"),
    ("skip_us", 0, 0, 1000000, "us", "wave: a tick stays silent this long after a send"),
    ("restart_us", 0, 0, 268435455, "us", "static rule: dead time of a restart"),
    ("forward_min_us", 0, 0, 1000000, "us", "static rule: least delay of a set-up frame"),
    ("forward_max_us", 0, 0, 1000000, "us", "static rule: greatest delay of a set-up frame"),
)
