"""What nodes and frames of managed flooding hold."""

from innervate.dialect.fields import DRAWS, clock, flag, number
from innervate.networks.flooding.protocol.sizes import BODY, OWN, PLACES, SEEN

CLOCK = 1073741823

STATE = (
    ("number", 0, 0, 254, "node", "who we are"),
    *DRAWS,
    ("id", 0, *number, "of our newest packet"),
    ("seen_from", SEEN, -1, 254, "node", "whose packets we have met; -1 nothing"),
    ("seen_id", SEEN, *number, "and which"),
    ("oldest", 0, 0, SEEN - 1, "place", "of those, that is used next"),
    ("waits", PLACES, *flag, "a packet waits here to be passed on"),
    ("kind", PLACES, 0, 3, "type", "of that packet"),
    ("origin", PLACES, 0, 254, "node", "who made it"),
    ("packet", PLACES, *number, "its id"),
    ("dest", PLACES, 0, 255, "node", "who is to have it; 255 = all"),
    ("hops", PLACES, 0, 7, "hops", "that it may still go, after ours"),
    ("start", PLACES, 0, 7, "hops", "that it could go at first"),
    ("want", PLACES, *flag, "its origin wants an acknowledgement"),
    ("ack", PLACES, *number, "of an acknowledgement: the id that it is for"),
    ("body", PLACES * BODY, 0, 65535, "raw", "what users say"),
    ("made", PLACES, 0, CLOCK, "time", "when it was handed in: a run's own"),
    ("open", OWN, *flag, "an own packet here is not acknowledged yet"),
    ("open_id", OWN, *number, "its id"),
    ("open_dest", OWN, 0, 255, "node", "who is to have it"),
    ("open_tries", OWN, 0, 15, "times", "that it was sent again"),
    ("open_body", OWN * BODY, 0, 65535, "raw", "what users say"),
    ("open_made", OWN, 0, CLOCK, "time", "when it was handed in: a run's own"),
    ("passed_on", 0, 0, 65535, "packets", "of others, modulo 65536"),
    ("spared", 0, 0, 65535, "packets", "not passed on, as another did, modulo 65536"),
)
FRAME = (
    ("kind", 0, 0, 3, "type", "1 packet, 2 acknowledgement"),
    ("origin", 0, 0, 254, "node", "who made it"),
    ("id", 0, *number, "of its origin's packets"),
    ("dest", 0, 0, 255, "node", "who is to have it; 255 = all"),
    ("hops", 0, 0, 7, "hops", "that it may still go"),
    ("start", 0, 0, 7, "hops", "that it could go at first"),
    ("want", 0, *flag, "its origin wants an acknowledgement"),
    ("ack", 0, *number, "the id that an acknowledgement is for"),
    ("body", BODY, 0, 65535, "raw", "what users say"),
    ("rssi", 0, -128, 127, "dBm", "how loud it came in"),
    ("made_at", 0, *clock, "when it was handed in: a run's own, not sent"),
)
PARAMS = (
    ("hops", 0, 0, 7, "hops", "that packets may be passed on"),
    ("slot_us", 0, 1, 500_000, "us", "of the wait before a packet is passed on"),
    ("cw_min", 0, 0, 10, "bits", "the wait of the faintest is one of 2^cw_min slots"),
    ("cw_max", 0, 0, 10, "bits", "that of the loudest one of 2^cw_max"),
    ("faint_dbm", 0, -128, 127, "dBm", "as faint, or fainter, counts as faintest"),
    ("loud_dbm", 0, -128, 127, "dBm", "as loud, or louder, counts as loudest"),
    ("retry_us", 0, 1, 100_000_000, "us", "an own packet is sent again if nobody acknowledged"),
    ("retries", 0, 0, 15, "times", "that it is sent again at most"),
    ("forget_us", 0, 1, 500_000_000, "us", "from forgetting one packet to the next"),
)
DEFAULTS = {"hops": 3, "slot_us": 320, "cw_min": 3, "cw_max": 8, "faint_dbm": -95,
            "loud_dbm": -65, "retry_us": 100_000, "retries": 3,
            "forget_us": 10_000_000}  # fmt: skip
EXPLORED = {"hops": 2, "retries": 1}
GIVEN = ((1, {"dest": 255}), (1, {"dest": 1}))
