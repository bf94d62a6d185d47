"""The meshes that the documentation says are explored completely; most of them in `make full`."""

import pytest

from innervate.networks.mesh.verify import model as mesh_model
from innervate.networks.mesh.verify import search as mesh_search
from innervate.networks.mesh.verify.command import DEATH_AND_ACK
from innervate.networks.mesh.verify.model import ASKED, QUICK, SHORT, MeshBudget, MeshModel
from innervate.networks.mesh.verify.mutants import WANTED

TWICE = (("e2e_tries", 1), ("transmissions", 2))
DEATH, CALM = MeshBudget(1, 0, 0, 0), MeshBudget(0, 0, 0, 0)
RETURNS, LOSSES = MeshBudget(1, 1, 0, 0), MeshBudget(0, 0, 2, 0)
LOSS = MeshBudget(0, 0, 1, 0)

# Links, failover, the rest of the model, states.
MESSAGES = [
    ("line", "search", {"offers": ((2, 0),), "budget": DEATH_AND_ACK}, 4_623),
    ("triangle", "search", {"offers": ((2, 0),), "budget": DEATH_AND_ACK}, 4_317),
    ("square", "search", {"offers": ((3, 0),), "budget": DEATH_AND_ACK}, 61_136),
    ("square", "graph", {"offers": ((3, 0),), "budget": DEATH_AND_ACK}, 58_692),
    ("kite", "search", {"offers": ((3, 0),), "budget": DEATH_AND_ACK}, 73_246),
    ("spare", "search", {"offers": ((4, 0),), "budget": DEATH}, 5_867),
    ("house", "graph", {"offers": ((4, 0),), "budget": DEATH}, 3_778),
    ("square", "search", {"offers": ((3, 0),), "budget": MeshBudget(2, 0, 0, 0)}, 6_796),
    ("kite", "graph", {"offers": ((3, 0),), "budget": MeshBudget(2, 0, 0, 0)}, 8_507),
    ("line", "search", {"offers": ((2, 0),), "budget": MeshBudget(0, 0, 0, 1, 1)}, 88_012),
    ("line", "search", {"offers": ((2, 0),), "settings": TWICE, "budget": MeshBudget()}, 36_269),
    ("line", "search", {"offers": ((2, 0),) * 2, "settings": TWICE, "budget": CALM}, 27_933),
    ("line", "search", {"robot": 2, "budget": CALM}, 16_658),
    ("0-1 1-2 2-3", "search", {"offers": ((3, 1),), "settings": WANTED, "budget": LOSS}, 695),
    (
        "0-1 1-2 2-3",
        "search",
        {"offers": ((3, 1),), "settings": WANTED, "budget": DEATH_AND_ACK},
        2_622,
    ),
]
GATEWAYS = [
    ("line", "search", {"standby": (2,), "beats": 7, "budget": RETURNS}, 75_908),
    ("line", "search", {"standby": (2,), "beats": 6, "budget": LOSSES}, 69_676),
    ("triangle", "search", {"standby": (1, 2), "beats": 6, "budget": RETURNS}, 47_717),
]
ASKING = [
    (links, "search", {"standby": standby, "beats": 3, "budget": budget, "settings": ASKED}, states)
    for links, standby, budget, states in (
        ("line", (2,), DEATH, 9_893),
        ("line", (2,), LOSS, 66_853),
        ("line", (2,), RETURNS, 249_069),
        ("triangle", (1, 2), DEATH, 31_614),
    )
]

QUICK_ONES = [case for case in MESSAGES if case[3] < 6_000]
OTHERS = [case for case in MESSAGES + GATEWAYS + ASKING if case not in QUICK_ONES]


@pytest.mark.parametrize(
    ("links", "failover", "keys", "states"),
    [*QUICK_ONES, *(pytest.param(*case, marks=pytest.mark.slow) for case in OTHERS)],
)
def test_nothing_breaks_and_the_documented_sizes_are_so(links, failover, keys, states):
    settings = QUICK if "beats" in keys else SHORT
    model = MeshModel(mesh_model.parse(links), failover, **{"settings": settings} | keys)
    found = mesh_search.explore(model, memory=4 << 30)
    assert (found.broken, found.tally.ended) == (0, "complete")
    assert found.tally.states == found.fair
    # States may change with the router; what the documentation prints is of the same size.
    assert states / 2 < found.tally.states < 2 * states


@pytest.mark.slow
@pytest.mark.parametrize("links", ["kite", "house", "prism"])
@pytest.mark.parametrize("failover", ["search", "graph"])
def test_walks_with_more_faults_than_can_be_exhausted_break_nothing(links, failover):
    made = mesh_model.parse(links)
    last = max(b for _, b in made)
    budget = MeshBudget(deaths=2, revivals=1, frames=3, acks=3, ticks=3)
    offers = ((last, 0), (0, last), (1, last))
    model = MeshModel(made, failover, offers, budget=budget, settings=(("suspect_s", 1.0),))
    found = mesh_search.wander(model, 200, length=120, live=False)
    assert (found.broken, found.tally.ended) == (0, "walked")
