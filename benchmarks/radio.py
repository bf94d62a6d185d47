"""Events per second of the compiled radio: saturated stations under practical CSMA/CD-R.

An event is a handler call or a frame received; each transmission begins and ends at every other
station. The best of a few runs counts, because other work on the machine only ever slows one down.
"""

from innervate import scenario
from innervate.networks.radio.sim.simulate import simulate

STATIONS = (10, 100)
EVENTS = 20_000_000
RUNS = 3


def measure(stations, checks=False):
    """Events per second; without checks also without rows."""
    packets = max(1, EVENTS // (5 * stations * stations))
    plan = scenario.plan(
        scenario.from_dict(
            {
                "kind": "radio",
                "stations": stations,
                "duration_s": 100_000.0,
                "traffic": {"kind": "saturated", "packets": packets},
            }
        )
    )
    best = {"events_per_s": 0.0}
    for _ in range(RUNS):
        result = simulate(plan, checks=checks, observe=checks)
        events = result.counts["handled"] + result.counts["decoded"]
        rate = events / result.wall_s
        if rate > best["events_per_s"]:
            simulated = result.ended_us / 1e6 / result.wall_s
            best = {"stations": stations, "events_per_s": rate, "s_per_s": simulated}
    return best
