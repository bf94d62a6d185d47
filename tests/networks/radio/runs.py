"""Radio plans for tests, without a scenario file."""

from innervate.networks.radio.scenario.plan import RadioPlan, Rules, parameters
from innervate.networks.radio.sim.simulate import simulate
from innervate.sim.tables import uniform
from tests.fixtures.scenarios import plan_head

START_US = 100_000


def delays(n, seed, low=52, high=104):
    """Symmetric pair delays."""
    drawn = (low + uniform(seed, "delay", n * n, high - low + 1)).tolist()
    return [[0 if i == j else drawn[min(i, j) * n + max(i, j)] for j in range(n)] for i in range(n)]


def radio_plan(
    n,
    packet_slots=25,
    ta=0,
    seed=1,
    traffic="disaster",
    spread=0,
    duration_s=60.0,
    packets=1,
    real=(52, 104),
    protocol="csma-cd-r/practical",
    **more,
):
    """A plan; `spread` us between the starts of a disaster, `packets` per station in saturation."""
    names = ("delay_us", "bit_us", *Rules._fields)
    params = parameters(packet_slots, ta, **{k: more.pop(k) for k in names if k in more})
    starts = (START_US + uniform(seed, "spread", n, spread + 1)).tolist()
    plan = RadioPlan(
        **plan_head("radio", seed, duration_s),
        protocol=protocol,
        stations=n,
        params=params,
        delays_us=delays(n, seed, *real),
        saturated=traffic == "saturated",
        wanted=packets * n,
        arrivals=[[at] for at in starts] if traffic == "disaster" else [[] for _ in range(n)],
        sizes=[[packet_slots] for _ in range(n)],
        absent=[0] * n,
    )
    for name, value in more.items():
        setattr(plan, name, value)
    return plan


def run(*args, plain=False, checks=True, trail=False, **more):
    """Run such a plan."""
    return simulate(radio_plan(*args, **more), plain=plain, checks=checks, trail=trail)
