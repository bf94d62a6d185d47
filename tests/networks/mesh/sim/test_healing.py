"""What healing costs with the timers of live links: one detection, and retries that back off."""

from collections import Counter
from itertools import pairwise

from innervate.networks.mesh.live.parameters import mesh_parameters
from innervate.networks.mesh.protocol.constants import DATA
from tests.networks.mesh.bench import Bench

READY = 8_000_000
EVERY_US = 8000  # no more than the eight messages that a node keeps are under way
HOP_US = 4000  # a frame takes 1000 us here: four of them, and some to spare


def live_bench(count, links, **settings):
    params = mesh_parameters(count, settings)
    given = {k: v for k, v in params.items() if k not in ("nodes", "px", "py", "after")}
    bench = Bench(count, links, gateway=1, **given)
    bench.check = lambda i: None  # ranges are held elsewhere; this runs many events
    bench.run(READY)
    return bench, params


def test_a_dead_neighbour_is_found_out_once_for_all_that_waits():
    ring = [(i, (i + 1) % 8) for i in range(8)]
    bench, params = live_bench(8, ring)
    bench.dead.add(2)
    began = bench.now
    for k in range(20):
        bench.send(0, 4, b"%d" % k, handle=k)
        bench.run(began + (k + 1) * EVERY_US)
    bench.run(bench.now + 500_000)
    first = {}
    for at, node, frame in bench.delivered:
        if node == 4 and frame.kind == DATA:
            first.setdefault(bytes(frame.body[: frame.length]), at)
    assert len(first) == 20
    told = [row for row in bench.of(7) if row[0] > began and row[1] == 1 and row[3] == 2]
    # Found out by one packet for all that waited: of those under way with it none is tried to the
    # end, and those that came later asked once before they went back.
    asked = [f.seq for at, i, f in bench.sent if at > began and i == 1 and f.link_dst == 2]
    by_packet = sorted(Counter(asked).values())
    assert by_packet[-1] == params["transmissions"]
    assert len(by_packet) == len(told)
    assert all(tries < params["transmissions"] for tries in by_packet[:-1])
    assert sum(by_packet) <= 2 * params["transmissions"]
    detection = params["transmissions"] * params["ack_us"]
    arrivals = sorted(first.values())
    gaps = [b - a for a, b in pairwise(arrivals)]
    assert arrivals[0] - began < detection + 3 * HOP_US
    # A newer message waits while an older one to the same recipient is tried again.
    assert max(gaps) < detection + 2 * params["e2e_us"]


def test_retries_of_a_message_double_their_wait():
    bench, params = live_bench(3, [(0, 1), (1, 2)], e2e_tries=4)
    bench.lost = lambda frame, to: frame.kind == DATA and to == 2
    began = bench.now
    bench.send(0, 2, b"?")
    bench.run(began + 3_000_000)
    sent = [at for at, node, frame in bench.sent if node == 0 and frame.kind == DATA]
    waits = [b - a for a, b in pairwise(sent) if b - a > params["e2e_us"] // 2]
    assert len(waits) >= 2
    for shorter, longer in pairwise(waits):
        assert 1.5 * shorter < longer < 3 * shorter
