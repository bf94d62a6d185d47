"""What nodes, frames and settings of Babel hold: (name, length, low, high, unit, meaning)."""

from innervate.dialect.fields import clock, flag, number
from innervate.networks.babel.protocol.constants import WANTED_MAX

cost = (0, 65535, "cost")
STATE = (
    ("number", 0, 0, 65535, "node", "who we are"),
    ("seqno", 0, *number, "of the route that we originate [3.2.2]; outlives a restart"),
    ("hello_no", 0, *number, "of our last Hello"),
    ("tick_at", 0, *clock, "when the next Hello is due"),
    ("beats", 0, 0, 64, "Hellos", "until the next periodic update"),
    # The neighbour table [3.2.4], an entry a port.
    ("neighbour", 4, -1, 65535, "node", "who is heard there; -1 = no entry"),
    ("hello_next", 4, *number, "of the Hello that is expected"),
    ("history", 4, 0, 65535, "bits", "Hellos that came, the newest in bit 0"),
    ("hello_us", 4, 0, 10_000_000, "us", "until the next Hello, as it promised"),
    ("hello_at", 4, *clock, "when that one is missing"),
    ("txcost", 4, *cost, "what the neighbour says of our Hellos; 65535 = infinite"),
    ("ihu_at", 4, *clock, "when that is too old"),
    ("cost", 4, *cost, "of the link [3.4.3]; 65535 = infinite"),
    # The route table [3.2.6], an entry a port.
    ("known", 4, *flag, "there is an entry"),
    ("seq", 4, *number, "with which the route was advertised"),
    ("metric", 4, *cost, "with which it was advertised; 65535 = retracted"),
    ("route_us", 4, 0, 10_000_000, "us", "until the next update, as it promised"),
    ("route_at", 4, *clock, "when the route expires"),
    ("asked", 4, *flag, "we have asked for an update, as it was about to expire"),
    ("parent", 0, -1, 3, "port", "of the route that is selected; -1 = none"),
    # The source table [3.2.5].
    ("fd_known", 0, *flag, "there is a feasibility distance"),
    ("fd_seq", 0, *number, "of the feasibility distance"),
    ("fd_metric", 0, *cost, "of the feasibility distance"),
    ("fd_at", 0, *clock, "when it is forgotten"),
    # The table of pending seqno requests [3.2.7].
    ("wanted", 0, *flag, "a request was sent and not answered yet"),
    ("wanted_seq", 0, *number, "that is requested"),
    ("wanted_tries", 0, 0, 3, "requests", "that follow if it stays unanswered"),
    ("wanted_us", 0, 0, WANTED_MAX, "us", "between the last two of them"),
    ("wanted_at", 0, *clock, "when the next is due, or it is given up"),
    ("said", 0, *cost, "our metric as we advertised it last"),
    ("soon", 0, *flag, "a triggered update is about to be sent"),
    ("copies", 0, 0, 5, "updates", "that repeat the one to be sent"),
    ("looking", 0, *flag, "a look at what has expired is due"),
    ("look_at", 0, *clock, "when"),
)
FRAME = (
    ("kind", 0, 0, 15, "type", "1 Hello .. 8 acknowledgment, see frames.py"),
    ("source", 0, 0, 65535, "node", "who sends it; of data: who sent it first"),
    ("hello_no", 0, *number, "of the Hello"),
    ("hello", 0, 0, 65535, "0.1 ms", "until the next Hello or IHU, or for an ack; 0 = no promise"),
    ("rxcost", 0, *cost, "IHU: what came of our Hellos; 65535 = infinite, 0 = there is none"),
    ("has_update", 0, *flag, "an update comes with the Hello"),
    ("seq", 0, *number, "of the route, or requested"),
    ("metric", 0, *cost, "of the route; 65535 = a retraction"),
    ("update", 0, 0, 65535, "0.1 ms", "until the next update"),
    ("hops", 0, 0, 255, "hops", "a seqno request may still go; of data: has gone"),
    ("value", 0, 0, 65535, "raw", "what data says; of an ack: what was in its request"),
    ("made_at", 0, *clock, "when data was handed in: a run's own, not sent"),
)
PARAMS = (
    ("pc", 0, 0, 65535, "node", "the source, which all others want to reach"),
    ("hello_us", 0, 1_000, 1_000_000, "us", "between two Hellos"),
    ("update_hellos", 0, 1, 64, "Hellos", "between two periodic updates"),
    ("etx", 0, *flag, "links are judged by ETX [A.2.2] instead of k-out-of-j [A.2.1]"),
    ("up_least", 0, 1, 16, "Hellos", "k: that many make a link up"),
    ("up_of", 0, 1, 16, "Hellos", "j: of the last so many; of ETX: the window"),
    ("nominal", 0, 1, 1024, "cost", "C: of a link that is up; least change that is told at once"),
    ("margin", 0, 0, 4096, "cost", "by which another route must be better to be taken instead"),
    ("urgent_us", 0, 1, 100_000, "us", "until a triggered update is sent"),
    ("copies", 0, 1, 5, "updates", "of every retraction"),
    ("request_us", 0, 100, 2_000_000, "us", "until a request is sent again, doubled each time"),
    ("gc_us", 0, 1_000, 400_000_000, "us", "until a feasibility distance is forgotten"),
)


def silent_us(params):
    """After what silence a link is down [A.2.1, A.2.2], and a Hello's time more, us."""
    missing = params.up_of if params.etx else params.up_of - params.up_least + 1
    return (missing + 1) * params.hello_us


# Appendix B with Hellos every 4 ms instead of 4 s, everything else in proportion.
DEFAULTS = {
    "hello_us": 4_000,
    "update_hellos": 4,
    "up_least": 2,
    "up_of": 3,
    "nominal": 96,
    "urgent_us": 200,
    "copies": 2,
    "request_us": 2_000,
    "gc_us": 180_000,
}
EXPLORED = {"update_hellos": 1, "up_least": 1, "up_of": 1, "copies": 1, "nominal": 1}
