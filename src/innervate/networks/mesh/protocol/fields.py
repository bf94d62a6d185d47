"""Declarations of the mesh: every field once, as (name, length, low, high, unit, meaning).

Arrays over nodes are as long as a capacity class has nodes: `node(n)`, `gate(n)` are of that class.
"""

from innervate.dialect.fields import DRAWS
from innervate.networks.mesh.protocol.constants import (
    BODY,
    CRC_BYTES,
    DATA_MAX,
    HEADER_BYTES,
    MTU,
    MTU_MAX,
    PATH_MAX,
)

TIME = 1073741823
NEIGHBOURS = 32  # in a network of up to SMALL nodes; hubs of larger ones hear more than a hundred
SMALL = 64
QUEUE = 8
WAITING = 8
PLACES_MAX = 64  # of either, where memory is no matter
GATHERED = 16
FORWARDED = 64
SKIPS = 16
WINDOW_WORDS = 5
POINTS = 48  # corners of a fence, holes included


def room(mtu):
    """Bytes of a payload that a frame's record and a place of the queue hold."""
    return max(BODY, mtu - HEADER_BYTES - CRC_BYTES)


def wait_room(mtu):
    """Bytes of a message that is kept."""
    return max(DATA_MAX, mtu - HEADER_BYTES - CRC_BYTES - PATH_MAX)


FRAME_HEAD = (
    ("kind", 0, 0, 63, "type", "type of the packet"),
    ("flags", 0, 0, 255, "flags", "see constants.py"),
    ("link_src", 0, 0, 255, "node", "transmitter of this hop"),
    ("link_dst", 0, 0, 255, "node", "receiver of this hop, 255 = all"),
    ("origin", 0, 0, 255, "node", "who made it"),
    ("dest", 0, 0, 255, "node", "who it is for"),
    ("seq", 0, 0, 65535, "number", "of its origin"),
    ("table_ver", 0, 0, 255, "version", "low byte of the table version used"),
    ("ttl", 0, 0, 255, "hops", "transmissions left; alarm floods: the instance"),
    ("path_len", 0, 0, PATH_MAX, "nodes", "how many in path"),
    ("path", PATH_MAX, 0, 255, "node", "every transmitter so far, the origin first"),
)
FRAME_TAIL = (
    ("rssi", 0, -128, 127, "dBm", "as received; set by the driver; in an ACK: as our frame was"),
)


def frame(mtu):
    """Fields of a frame of so many bytes at most."""
    most = room(mtu)
    return (
        *FRAME_HEAD,
        ("length", 0, 0, most, "bytes", "of the payload"),
        ("body", most, 0, 255, "byte", "the payload, as on the wire"),
        *FRAME_TAIL,
    )


FRAME = frame(MTU)

ITEM_HEAD = (
    ("handle", 0, 0, 65535, "number", "its owner's name for the message; SENT: which frame"),
    ("ok", 0, 0, 1, "flag", "SENT: 1 = on the air, 0 = the channel stayed busy"),
    ("dest", 0, 0, 255, "node", "recipient; 255 all, 254 the monitor"),
    ("flags", 0, 0, 255, "flags", "END_TO_END, PRIORITY"),
)
ITEM_PLACE = (
    ("x", 0, -32768, 32767, "unit", "position in fence.unit_cm"),
    ("y", 0, -32768, 32767, "unit", "position in fence.unit_cm"),
    ("vx", 0, -127, 127, "2 cm/s", "speed"),
    ("vy", 0, -127, 127, "2 cm/s", "speed"),
)


def item(mtu):
    """Fields of what a user hands down, where a frame has so many bytes at most."""
    return (
        *ITEM_HEAD,
        ("length", 0, 0, wait_room(mtu), "bytes", "of the payload"),
        ("body", wait_room(mtu), 0, 255, "byte", "the payload"),
        *ITEM_PLACE,
    )


ITEM = item(MTU)

# What an action of a node's outbox has (dialect/outbox.py).
ACTION = (
    ("kind", 0, 0, 15, "kind", "1 SEND, 2 SET_TIMER, 3 DELIVER, 4 REPORT"),
    ("a", 0, 0, 63, "number", "0, timer, kind of packet or code"),
    ("b", 0, -32768, 1073741823, "number", "delay, time of the timer or a of the report"),
    ("c", 0, 0, 65535, "number", "flags or b of the report"),
)


def places(n):
    """How many neighbours a node remembers in a network of up to n nodes; in a large one all."""
    return min(n, NEIGHBOURS) if n <= SMALL else n


def node(n, queue=QUEUE, kept=WAITING, mtu=MTU, most=0):
    """Fields of a node in a network of up to n, with room for so much and most neighbours."""
    k = most or places(n)
    near, far = neighbours(k) + links(k), tables(n) + packets(n, kept, mtu)
    return OWN + near + far + WATCH + watched(n) + queued(queue, mtu)


OWN = (
    ("number", 0, 0, 253, "node", "who we are"),
    ("rank", 0, -1, 253, "rank", "0 gateway, 1.. standby: who is next, -1 neither"),
    ("robot", 0, 0, 1, "flag", "it moves and has a fence"),
    *DRAWS,
    ("seq", 0, 0, 65535, "number", "of our newest packet"),
    ("ticks", 0, 0, 65535, "ticks", "since we switched on; wraps"),
    ("epoch", 0, 0, 255, "epoch", "of the gateway we follow"),
    ("round", 0, 0, 65535, "round", "newest discovery round"),
    ("known", 0, 0, 1, "flag", "we follow a gateway"),
    ("gateway", 0, 0, 255, "node", "whom we follow; 255 nobody"),
    ("gone", 0, 0, 255, "node", "whom we followed till this round's gateway led; 255 nobody"),
    ("active", 0, 0, 65535, "version", "tables in force, as the gateway says"),
    ("depth", 0, 0, 255, "hops", "ours, as advertised; 255 unknown"),
    ("due", 0, 0, 3, "step", "ROUND: 0 nothing, 1 look again, 2 respond"),
    ("tick_at", 0, 0, TIME, "us", "the newest tick"),
    ("parent", 0, 0, 255, "node", "who brought the round's first request; 255 nobody"),
    ("quiet", 0, 0, 65535, "ticks", "since the newest request"),
    ("leading", 0, 0, 1, "flag", "we are the gateway now"),
    ("silent", 0, 0, 15, "waits", "standby: since the gateway's newest sign of life"),
    ("tolerance", 0, 0, 64, "eighths", "standby: of a question more in vain, answers were late"),
    ("places", 0, QUEUE, PLACES_MAX, "frames", "our queue holds"),
    ("kept", 0, WAITING, PLACES_MAX, "messages", "are kept until acknowledged end to end"),
    ("round_trip", 0, 0, 16777215, "us", "smoothed, of end-to-end acks; 0 unknown"),
    ("strain", 0, 0, 176, "acks/4", "missing from neighbours that live, beyond what links explain"),
    ("search_backoff", 0, 0, 3, "doublings", "of the wait till unreachable ones are tried again"),
    ("pause", 0, -1, TIME, "us", "searches, at worst all messages, wait until then; -1 none"),
)


def neighbours(k):
    """The neighbour table: k places, the loudest when there are more."""
    return (
        ("neighbour", k, 0, 255, "node", "neighbour; 255 = free place"),
        ("heard", k, 0, 65535, "ticks", "when we heard it last"),
        ("rssi", k, -512, 511, "dBm/4", "smoothed"),
        ("ack_ratio", k, 0, 255, "1/255", "of our transmissions to it that it acknowledged"),
        ("misses", k, 0, 31, "transmissions", "to it since it acknowledged one"),
        ("suspect", k, 0, 7, "flags", "1 it does not answer, until `until`; 2, 4 not heard since"),
        ("until", k, 0, 65535, "ticks", "... then it is trusted again"),
        ("round_rssi", k, -128, 127, "dBm", "of its request in this round"),
        ("round_depth", k, 0, 255, "hops", "it advertised in this round; 255 not heard"),
    )


def links(k):
    """What is known of links to the neighbours, with `ack_adapt`, `hop_frames` or `gather` alone.

    Without them nothing of it is used, and it is not counted in a node's 4 KiB (decision 0015).
    """
    return (
        ("woken", 0, 0, 1, "flag", "`gather`: what is due goes as soon as all was heard"),
        ("ack_at", 0, -1, TIME, "us", "`hop_frames`: the first ack is overdue then; -1 none"),
        ("acks", 0, 0, GATHERED, "acks", "`gather`: of hops, that we owe"),
        ("ack_to", GATHERED, 0, 255, "node", "... to whom"),
        ("ack_origin", GATHERED, 0, 255, "node", "... whose packet"),
        ("ack_seq", GATHERED, 0, 65535, "number", "... its number"),
        ("ack_rssi", GATHERED, -128, 127, "dBm", "... how it came"),
        ("hop_trip", k, 0, 1048576, "us", "smoothed round trip to it; 0 unknown"),
        ("hop_spread", k, 0, 1048576, "us", "... its mean deviation"),
        ("hop_doubled", k, 0, 2, "doublings", "of the wait for its acks: retried frames came"),
        ("hop_under", k, 0, PLACES_MAX, "frames", "under way to it"),
        ("hop_most", k, 1, PLACES_MAX, "frames", "may be under way to it"),
        ("hop_cut", k, -1, TIME, "us", "when it was halved, if no ack came since; -1"),
        ("hop_failed", k, -1, TIME, "us", "when a frame began that it did not answer; -1 none"),
    )


def tables(n):
    """Routing tables: the one in force and the one that comes in; or the whole graph."""
    return (
        ("next", 2 * n, 0, 255, "node", "two banks: next hop per destination; 255 none"),
        ("alt", 2 * n, 0, 255, "node", "two banks: alternate; 255 none"),
        ("bank", 0, 0, 1, "bank", "which is in force"),
        ("version", 0, 0, 65535, "version", "of the bank in force; 0 = none yet"),
        ("table_epoch", 0, 0, 255, "epoch", "of the gateway that made it"),
        ("new_version", 0, 0, 65535, "version", "of the bank that comes in; 0 none"),
        ("new_epoch", 0, 0, 255, "epoch", "of the gateway that made that"),
        ("parts", 0, 0, 65535, "bits", "its fragments that are here"),
        ("part_count", 0, 0, 15, "fragments", "how many it has"),
        ("ready", 0, 0, 1, "flag", "it is whole and waits to be activated"),
        ("edges", n * row_bytes(n), 0, 255, "bits", "graph: adjacency, 8 nodes a byte"),
        ("far", n, 0, 255, "hops", "scratch: distances"),
        ("line", n, 0, 253, "node", "scratch: nodes in order of distance"),
    )


def row_bytes(n):
    """Bytes in a row of the adjacency matrix."""
    return (n + 7) // 8


def packets(n, kept=WAITING, mtu=MTU):
    """What is remembered of packets."""
    most = wait_room(mtu)
    return (
        ("newest", n, 0, 65535, "number", "per origin: newest seq delivered"),
        ("window", n * WINDOW_WORDS, 0, 32767, "bits", "per origin: which behind it were"),
        ("heard_seq", n, 0, 65535, "number", "per origin: the seq that its window began with"),
        ("idle", n, 0, 255, "ticks", "per origin: till the window is cleared; 0 = it is"),
        ("met", row_bytes(n), 0, 255, "bits", "recipients that acknowledged something"),
        ("done_origin", FORWARDED, 0, 255, "node", "forwarded: origin; 255 = free place"),
        ("done_seq", FORWARDED, 0, 65535, "number", "forwarded: seq"),
        ("done_kind", FORWARDED, 0, 255, "type", "forwarded: type, 64 x parity, flood instance"),
        ("done_from", FORWARDED, 0, 255, "node", "forwarded: who gave it to us first"),
        ("done_hops", FORWARDED, 0, PATH_MAX, "hops", "forwarded: how long its path was"),
        ("done_at", 0, 0, 63, "place", "forwarded: the next to be overwritten"),
        ("skip_origin", SKIPS, 0, 255, "node", "failed neighbours per packet; 255 free"),
        ("skip_seq", SKIPS, 0, 65535, "number", "... seq of the packet"),
        ("skip_neighbour", SKIPS, 0, 255, "node", "... the neighbour"),
        ("skip_at", 0, 0, 15, "place", "... the next to be overwritten"),
        ("bad_neighbour", SKIPS, 0, 255, "node", "bad neighbours per destination; 255 free"),
        ("bad_dest", SKIPS, 0, 255, "node", "... the destination"),
        ("bad_at", 0, 0, 15, "place", "... the next to be overwritten"),
        ("wait_seq", kept, 0, 65535, "number", "waits for an end-to-end ack: seq"),
        ("wait_dest", kept, 0, 255, "node", "... recipient"),
        ("wait_kind", kept, 0, 63, "type", "... 0 = free place"),
        ("wait_flags", kept, 0, 255, "flags", "... flags"),
        ("wait_tries", kept, 0, 255, "tries", "... sent so often"),
        ("wait_due", kept, 0, TIME, "us", "... when it is sent again"),
        ("wait_at", kept, 0, TIME, "us", "... when it was sent first"),
        ("wait_sent", kept, 0, TIME, "us", "... when it was sent last"),
        ("wait_handle", kept, 0, 65535, "number", "... its owner's name"),
        ("wait_hop", kept, 0, 1, "flag", "... its owner was told that it has left"),
        ("wait_length", kept, 0, most, "bytes", "... payload"),
        ("wait_body", kept * most, 0, 255, "byte", "... payload"),
        ("wait_room", 0, DATA_MAX, wait_room(MTU_MAX), "bytes", "... each has in wait_body"),
    )


WATCH = (
    ("x", 0, -32768, 32767, "unit", "robot: where it is"),
    ("y", 0, -32768, 32767, "unit", "robot: where it is"),
    ("vx", 0, -127, 127, "2 cm/s", "robot: speed"),
    ("vy", 0, -127, 127, "2 cm/s", "robot: speed"),
    ("outside", 0, 0, 2, "state", "robot: 0 inside, 1 about to cross, 2 outside"),
    ("alarm", 0, 0, 255, "number", "of our newest alarm"),
    ("heard_out", 0, 0, 1, "flag", "robot: the monitor acknowledged that it is outside"),
    ("placed", 0, 0, 1, "flag", "robot: its position is known"),
)


def watched(n):
    """What monitors and witnesses know of robots."""
    return (
        ("missed", n, 0, 255, "ticks", "since the robot was heard; 255 = never or no robot"),
        ("raised", n, 0, 7, "flags", "1 lost, 2 outside: raised for it, not yet cleared"),
    )


def queued(places, mtu=MTU):
    """Frames that wait to be sent, or for their hop's ack; not counted as state of a node."""
    most = room(mtu)
    return (
        ("q_state", places, 0, 3, "state", "0 free, 1 waits, 2 handed down, 3 waits for its ack"),
        ("q_rank", places, 0, 3, "priority", "0 alarm, 1 control, 2 data"),
        ("q_order", places, 0, TIME, "number", "first in, first out"),
        ("q_due", places, 0, TIME, "us", "not to be sent before"),
        ("q_born", places, 0, TIME, "us", "since when it waits here"),
        ("q_sent", places, 0, TIME, "us", "handed down last"),
        ("q_begun", places, 0, TIME, "us", "handed down first, for this hop"),
        ("q_tries", places, 0, 255, "tries", "transmissions of this hop so far"),
        ("q_fails", places, 0, 255, "failures", "hops that failed here"),
        ("q_copies", places, 0, 19, "copies", "broadcasts: still to be sent"),
        ("q_from", places, 0, 255, "node", "who gave it to us; 255 = we made it"),
        ("q_owner", places, -1, PLACES_MAX - 1, "place", "of the message kept; -1 none"),
        ("q_kind", places, 0, 63, "type", "the frame"),
        ("q_flags", places, 0, 255, "flags", "the frame"),
        ("q_link_dst", places, 0, 255, "node", "the frame"),
        ("q_origin", places, 0, 255, "node", "the frame"),
        ("q_dest", places, 0, 255, "node", "the frame"),
        ("q_seq", places, 0, 65535, "number", "the frame"),
        ("q_ver", places, 0, 255, "version", "the frame"),
        ("q_ttl", places, 0, 255, "hops", "the frame"),
        ("q_path_len", places, 0, PATH_MAX, "nodes", "the frame"),
        ("q_path", places * PATH_MAX, 0, 255, "node", "the frame"),
        ("q_length", places, 0, most, "bytes", "the frame"),
        ("q_body", places * most, 0, 255, "byte", "the frame"),
        ("q_room", 0, BODY, room(MTU_MAX), "bytes", "each has in q_body"),
        ("q_next", 0, 0, TIME, "number", "order of the next one"),
        ("busy", 0, -1, PLACES_MAX - 1, "place", "handed down, or waits for its ack; -1 none"),
    )


def gate(n, most=0):
    """What a gateway, and only a gateway or standby, has besides; of so many neighbours a node."""
    return (
        ("heard", (n * n + 3) // 4, 0, 255, "rounds", "who was heard by whom, 4 pairs a byte"),
        ("known", n * row_bytes(n), 0, 255, "bits", "adjacency after the newest round"),
        ("dist", n * n, 0, 255, "hops", "from everyone to everyone; 255 none"),
        ("neighbours", most or places(n), 0, 253, "node", "scratch: of a node, by number"),
        ("neighbour_count", 0, 0, most or places(n), "nodes", "... how many"),
        ("neighbours_of", 0, 0, 255, "node", "... of whom; 255 nobody"),
        ("line", n, 0, 253, "node", "scratch: nodes in order of distance"),
        ("far", n, 0, 255, "hops", "scratch: distances without one node"),
        ("next", n, 0, 255, "node", "scratch: a node's table"),
        ("alt", n, 0, 255, "node", "scratch: its alternates"),
        ("mark_a", n, 0, TIME, "hash", "of the table that the node acknowledged"),
        ("mark_b", n, 0, TIME, "hash", "... a second one"),
        ("job", n, 0, 3, "state", "its table: 0 current, 1 to send, 2 sent, 3 given up"),
        ("job_tries", n, 0, 255, "tries", "of the job"),
        ("job_next", n, 0, 15, "fragment", "the next to be queued"),
        ("job_count", n, 0, 15, "fragments", "how many the table has"),
        ("job_parts", n, 0, 65535, "bits", "fragments that it has; 32768: it told"),
        ("job_due", n, 0, TIME, "us", "sent: when it is sent again"),
        ("job_a", n, 0, TIME, "hash", "of the table that is on its way"),
        ("job_b", n, 0, TIME, "hash", "... a second one"),
        ("step", 0, 0, 3, "step", "ROUND: 0 idle, 1 collecting, 2 asked again"),
        ("wait", 0, 0, 65535, "ticks", "till the next round"),
        ("period", 0, 0, 65535, "ticks", "between rounds now"),
        ("links", 0, 0, 65535, "links", "known after the newest round"),
        ("version", 0, 0, 65535, "version", "of the tables on their way or in force"),
        ("open", 0, 0, 65535, "ticks", "tables are on their way; less 1: how long a round waits"),
        ("sum_a", 0, 0, TIME, "hash", "of the graph of the newest tables"),
        ("part", 0, 0, 15, "fragment", "graph: next to be flooded; standby: next to be asked for"),
        ("taken", 0, 0, 1, "flag", "taken over: all keep their tables until the next round"),
    )


PARAMS = (
    ("nodes", 0, 1, 254, "nodes", "ids are 0 to nodes - 1"),
    ("row", 0, 1, 32, "bytes", "of an adjacency row in this capacity class"),
    ("places", 0, 1, 254, "neighbours", "in the neighbour table of this class"),
    ("width", 0, 1, 254, "nodes", "the capacity class"),
    ("mtu", 0, 64, MTU_MAX, "bytes", "a whole frame"),
    ("mode", 0, 0, 2, "mode", "0 tables, 1 whole graph, 2 table-free"),
    ("discovery", 0, 1, 3, "reading", "1 tree, 2 each, 3 list"),
    ("failover", 0, 0, 3, "reading", "0 random, 1 loudest, 2 alternate, 3 alternates then search"),
    ("avoid_origin", 0, 0, 1, "flag", "random, loudest: not the origin; else not the sender"),
    ("retry", 0, 0, 1, "flag", "a packet whose hop failed is sent another way"),
    ("reliable", 0, 0, 1, "flag", "messages are kept until acknowledged end to end"),
    ("activation", 0, 0, 1, "flag", "tables wait until all have theirs"),
    ("told", 0, 0, 1, "flag", "the layer below says SENT"),
    ("transmissions", 0, 1, 15, "tries", "per hop"),
    ("hop_acks", 0, 0, 1, "flag", "hops acknowledge; 0 = SENT says that the frame was received"),
    ("ack_us", 0, 1, 16777215, "us", "wait for a hop's ack, from SENT"),
    ("ack_adapt", 0, 0, 1, "flag", "a hop's ack may take its neighbour's round trip longer"),
    ("hop_frames", 0, 0, PLACES_MAX, "frames", "to a neighbour under way at most; 0: one to all"),
    ("gather", 0, 0, 1, "flag", "all that came is handled before something goes; acks go together"),
    ("queue", 0, QUEUE, PLACES_MAX, "frames", "that wait or are under way"),
    ("kept", 0, WAITING, PLACES_MAX, "messages", "kept until acknowledged end to end"),
    ("suspect_us", 0, 1, 268435455, "us", "a neighbour that does not answer is avoided"),
    ("min_rssi", 0, -128, 127, "dBm", "weaker links are not reported"),
    ("faint", 0, -128, 127, "dBm", "a first request below it waits for better; <= min_rssi: stays"),
    ("poor", 0, -128, 127, "dBm", "links that are fainter lose frames in a free channel, too"),
    ("jitter_us", 0, 0, 16777215, "us", "requests are passed on within"),
    ("copies", 0, 1, 15, "copies", "of a request"),
    ("flood_us", 0, 0, 16777215, "us", "floods are passed on within"),
    ("listen_us", 0, 1, 268435455, "us", "after the first request, before responding"),
    ("spread_us", 0, 1, 268435455, "us", "responses are spread over"),
    ("collect_us", 0, 1, 268435455, "us", "gateway: from its request to its graph"),
    ("tick_us", 0, 1000, 16777215, "us", "beacon period and beat of all slow things"),
    ("period", 0, 1, 65535, "ticks", "between discovery rounds"),
    ("period_max", 0, 1, 65535, "ticks", "... at most, while nothing changes"),
    ("dead", 0, 1, 65535, "ticks", "standby: without a request"),
    ("dead_step", 0, 0, 65535, "ticks", "... more for every rank behind the first"),
    ("standby", 0, 0, 1, "flag", "there is one: the period is not stretched"),
    ("asks", 0, 0, 1, "flag", "who is named and did not respond is asked once more in a round"),
    ("jobs", 0, 1, 15, "nodes", "tables under way at the same time"),
    ("job_us", 0, 1, 67108863, "us", "wait for a table's ack, first try, near"),
    ("job_tries", 0, 0, 15, "tries", "more for a table"),
    ("e2e_us", 0, 1000, 16777215, "us", "wait for an end-to-end ack"),
    ("e2e_adapt", 0, 0, 1, "flag", "at least e2e_us, else 4 smoothed round trips"),
    ("e2e_tries", 0, 0, 15, "tries", "more"),
    ("forget", 0, 1, 255, "ticks", "duplicate window of an origin that is silent"),
    ("monitor", 0, 0, 255, "node", "254: whoever is gateway"),
    ("watch", 0, 0, 1, "flag", "robots tell the monitor where they are, every tick"),
    ("lost", 0, 1, 253, "ticks", "a robot not heard for so long is lost"),
    ("flood", 0, 0, 2, "when", "alarms: 0 never, 1 CROSS at once and others late, 2 all at once"),
    ("instances", 0, 0, 3, "floods", "at most, of an alarm"),
    ("clear_margin", 0, 0, 32767, "unit", "inside by so much again: CLEAR"),
    ("predict_ms", 0, 0, 10000, "ms", "outside so soon: PREDICT"),
    ("unit_cm", 0, 1, 100, "cm", "of coordinates"),
    ("points", 0, 0, POINTS, "corners", "of the fence, all rings; 0 none"),
    ("px", POINTS, -32768, 32767, "unit", "corners"),
    ("py", POINTS, -32768, 32767, "unit", "corners"),
    ("after", POINTS, 0, 47, "corner", "the corner that follows in its ring"),
    ("fence", 0, 0, 255, "number", "name of the fence in alarms"),
    ("guard_us", 0, 0, 2000000, "us", "standby: wait for a sign of the gateway; 0: for requests"),
    ("recent", 0, 0, 1, "flag", "loudest: of those heard last, whoever is loudest"),
    ("on_demand", 0, 0, 1, "flag", "who knows no way to a recipient floods the message"),
)
