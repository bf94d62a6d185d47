"""Runs of the baselines on the event-level channel, for tests."""

from innervate.networks.radio.scenario.baselines import Draws, baseline
from innervate.networks.radio.sim.simulate import simulate
from tests.networks.radio.runs import radio_plan

SLOT_US = 208
TAU_US = 104


def baseline_plan(mac, n, *args, **more):
    """A plan as radio_plan makes it, for a baseline; equal delays of half a slot if not said."""
    chosen = {name: more.pop(name) for name in Draws._fields if name in more}
    more.setdefault("real", (TAU_US, TAU_US))
    plan = radio_plan(n, *args, protocol=mac, **more)
    plan.params = baseline(mac, n, plan.params, Draws(**chosen))
    return plan


def run_baseline(mac, n, *args, plain=False, checks=True, **more):
    """Run such a plan."""
    return simulate(baseline_plan(mac, n, *args, **more), plain=plain, checks=checks)


def saturate(mac, n, packet_slots=5, packets=20_000, **more):
    """A saturated run of that many packets of all stations together."""
    more.setdefault("duration_s", 1e4)
    return run_baseline(
        mac, n, packet_slots, traffic="saturated", packets=packets // n, checks=n <= 10, **more
    )
