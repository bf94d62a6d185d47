"""Babel at the job of the skin: a network over cables whose nodes all want to reach the PC."""

from typing import Any

from innervate import scenario
from innervate.networks.babel.protocol.constants import REPORT_LINK, REPORT_ROUTE
from innervate.networks.babel.protocol.fields import DEFAULTS
from innervate.papers import cabled
from innervate.papers.jobs import Entry, Given
from innervate.running.simulating import simulate

JOB = "skin"
OUR_PC = "hub"  # of four ports, as every node here has
SLOWEST_PPM = 1000


def tables(given: Given, seed: int, **protocol: int) -> dict[str, Any]:
    """The scenario of a case: Babel with Hellos as often as the case has beacons."""
    harm, made = cabled.drawn(given, seed), cabled.wiring(given)
    names = [OUR_PC, *made.names[1:]]
    beat = given["beacon_us"]
    scaled = {name: us * beat // DEFAULTS["hello_us"] for name, us in DEFAULTS.items()
              if name.endswith("_us")}  # fmt: skip
    at_s = harm.at_us / 1e6
    cuts = [made.cables[place] for place in harm.cables]
    events = [{"at_s": at_s, "action": "cut", "link": f"{names[a]}-{names[b]}"}
              for a, _, b, _ in cuts]  # fmt: skip
    # The PC has to be node 0: the first cable that names it comes first.
    cables = sorted(made.cables, key=lambda cable: 0 not in (cable[0], cable[2]))
    cables = [cable if cable[2] else (*cable[2:], *cable[:2]) for cable in cables]
    order = list(dict.fromkeys(node for a, _, b, _ in cables for node in (a, b)))
    kills = [{"at_s": at_s, "action": "kill", "node": order.index(node)} for node in harm.nodes]
    return {
        "kind": "babel",
        "seed": seed,
        "duration_s": cabled.end_us(given, harm) / 1e6,
        "cables": [f"{names[a]}.{p}-{names[b]}.{q}" for a, p, b, q in cables],
        "drift_ppm": SLOWEST_PPM,
        "start_us": beat,
        "links": {"loss": given["loss"]},
        "protocol": {**scaled, **protocol},
        "event": [*events, *kills],
    }


def measure(given: Given, seed: int, **protocol: int) -> dict[str, Any]:
    """One run of a case."""
    plan = scenario.plan(scenario.from_dict(tables(given, seed, **protocol)))
    result = simulate(plan, checks=False)
    number = cabled.wiring(given).number
    whose = [number.get(name, 0) for name in plan.graph.names]
    rows = result.rows["rows"]
    told = rows[rows["code"] == REPORT_ROUTE]
    changes = [(int(row["time"]), whose[row["node"]], int(row["a"])) for row in told]
    downs = rows["time"][(rows["code"] == REPORT_LINK) & (rows["b"] == 0)]
    harm = cabled.drawn(given, seed)
    return cabled.measured(given, harm, changes, downs.tolist(), result.counts.sent)


def warm_up() -> None:
    """Compile the loop that all entries run on."""
    simulate(scenario.plan(scenario.from_dict({"kind": "babel", "duration_s": 0.01})))


def with_k(given: Given, seed: int) -> dict[str, Any]:
    """A link is down when the last `k` Hellos are missing, as a port of the skin is."""
    return measure(given, seed, up_least=1, up_of=given["k"])


def etx(given: Given, seed: int) -> dict[str, Any]:
    """Links by ETX of the last six Hellos; another route must be better by a whole good link."""
    found = {"etx": 1, "up_least": 1, "up_of": 6, "nominal": 256, "margin": 256}
    return measure(given, seed, **found)


def entry(name: str, what: str, run: Any) -> Entry:
    """An entry that is Babel, in some setting."""
    return Entry(JOB, name, f"RFC 8966 over cables; {what}", run, warm_up, 0.2)


ENTRIES = (
    entry(
        "Babel, 2 of 3",
        "hop count, a link is up while 2 of the last 3 Hellos came, all times as in its appendix B "
        "with a Hello a beacon period",
        measure,
    ),
    entry("Babel, 1 of k", "the same, a link is up while one of the last k Hellos came", with_k),
    entry(
        "Babel, ETX",
        "link costs by ETX of the last 6 Hellos, another route must be better by 256",
        etx,
    ),
)
