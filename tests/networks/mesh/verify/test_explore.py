"""The mesh explored: the random failover loops for good, search and graph keep their promises."""

import random
from dataclasses import replace

import pytest

from innervate import scenario
from innervate.networks.mesh.plot import counterexample as mesh_counterexample
from innervate.networks.mesh.protocol import constants as const
from innervate.networks.mesh.sim.simulate import simulate
from innervate.networks.mesh.verify import fair as mesh_fair
from innervate.networks.mesh.verify import local as mesh_local
from innervate.networks.mesh.verify import model as mesh_model
from innervate.networks.mesh.verify import net as mesh_net
from innervate.networks.mesh.verify import replay as mesh_replay
from innervate.networks.mesh.verify import search as mesh_search
from innervate.networks.mesh.verify import story as story
from innervate.networks.mesh.verify.first import begin
from innervate.networks.mesh.verify.model import SHORT, MeshBudget, MeshModel
from innervate.verify.cases import budget_of
from innervate.verify.errors import VerifyError

NOTHING = MeshBudget(0, 0, 0, 0)
LOST_ACK = MeshBudget(deaths=0, frames=0, acks=1)
DEATH = MeshBudget(deaths=1, frames=0, acks=0)


def model(links, failover="search", **keys):
    return MeshModel(mesh_model.parse(links), failover, **{"settings": SHORT} | keys)


# The shortest stories: an ack is lost; or a node dies, and there is another way.
LOOPS = [
    (model("line", "random", offers=((1, 0), (1, 0)), reliable=False, budget=LOST_ACK), [1, 2], 7),
    (model("spare", "random", offers=((3, 0), (3, 0)), reliable=False, budget=DEATH), [3, 4], 8),
]


def test_the_ring_of_a_story_is_that_of_its_last_scene():
    found = mesh_search.explore(LOOPS[0][0])
    rings = []
    for events in range(1, 4):
        rings.append(story.tell(replace(found, path=found.path[:events])).ring)
    assert rings == [[], [], [1, 2]]


@pytest.mark.parametrize(("made", "ring", "events"), LOOPS)
def test_the_random_failover_closes_a_loop_of_two_for_good(made, ring, events):
    found = mesh_search.explore(made)
    told = story.tell(found)
    assert found.broken == mesh_local.BROKEN_ROUND
    assert (told.ring, len(told.sentences)) == (ring, events)
    assert f"between nodes {ring[0]} and {ring[1]}, for good" in told.lines()[-1]
    text = mesh_replay.write(told)
    result = simulate(scenario.plan(scenario.loads(text)))
    assert mesh_replay.loop_of(text, told.dest) == ring
    # The recipient lives and has a way; forty messages later not one has come.
    data = result.delivered["kind"] == const.DATA
    assert sum(data) <= 1
    assert len(result.sent[result.sent["time"] > 90e6]) > 5 * hops_offered_late(result)
    picture = mesh_counterexample.draw(told).render()
    assert picture.count('class="ring"') == 2 * 3  # a line and two barbs each


@pytest.mark.parametrize("failover", ["search", "graph"])
@pytest.mark.parametrize(("made", "ring", "events"), LOOPS)
def test_the_others_do_not(made, ring, events, failover):
    found = mesh_search.explore(replace(made, failover=failover))
    assert (found.broken, found.tally.ended) == (0, "complete")
    assert found.tally.depth > events


@pytest.mark.parametrize("failover", ["search", "graph"])
def test_a_message_comes_once_and_comes_whoever_dies(failover):
    budget = MeshBudget(deaths=1, frames=0, acks=1)
    found = mesh_search.explore(model("line", failover, offers=((2, 0),), budget=budget))
    assert (found.broken, found.tally.ended) == (0, "complete")
    assert found.fair == found.tally.states > 1000
    assert found.calls < found.tally.generated


@pytest.mark.parametrize("failover", ["search", "graph"])
def test_losses_on_a_bridge_do_not_silence_who_is_behind_it(failover):
    # The relay suspects the recipient for longer than the origin tries, and may not give back
    # what comes without having asked once more.
    budget = MeshBudget(deaths=0, frames=3, acks=0)
    made = model("line", failover, offers=((2, 0),), budget=budget, settings=())
    found = mesh_search.explore(made, states=3_000)
    assert found.broken == 0, story.tell(found).sentences


def test_a_relay_that_restarts_gives_everything_back_until_the_next_round():
    budget = MeshBudget(deaths=1, revivals=1, frames=0, acks=0)
    found = mesh_search.explore(model("line", offers=((2, 0),), budget=budget))
    assert found.broken == mesh_local.BROKEN_UNHEARD
    assert "is switched on again" in " ".join(story.tell(found).sentences)


def test_two_gateways_agree_when_the_first_returns():
    made = MeshModel(
        mesh_model.parse("line"), standby=(2,), beats=4, budget=DEATH, settings=mesh_model.QUICK
    )
    found = mesh_search.explore(made)
    assert (found.broken, found.tally.ended) == (0, "complete")
    assert 0 < found.longest <= found.nets.calm_beats() * 1_000_000


def test_who_dies_before_it_responds_and_is_asked_by_name_holds_nothing_up():
    """Any order of events; with `asks` there are more of them, and all end well."""
    states = []
    for asks in (False, True):
        settings = (*mesh_model.QUICK, ("transmissions", 1), ("asks", asks))
        found = mesh_search.explore(model("line", settings=settings, budget=DEATH, beats=4))
        assert (found.broken, found.tally.ended) == (0, "complete")
        assert found.tally.states == found.fair
        states.append(found.fair)
    assert states[1] > states[0]


def test_gateways_that_never_agree_are_found(monkeypatch):
    monkeypatch.setattr(mesh_net.Nets, "calm_beats", lambda self: 1)
    made = MeshModel(
        mesh_model.parse("line"), standby=(2,), beats=6, budget=DEATH, settings=mesh_model.QUICK
    )
    found = mesh_search.explore(made)
    assert found.broken == mesh_local.BROKEN_GATEWAYS
    assert story.tell(found).lines()[-1].startswith("So: nodes do not agree on one gateway")


def hops_offered_late(result):
    """Messages offered in the last ten seconds."""
    return sum(offer.at_us > 90e6 for offer in result.plan.offers)


def walk(nets, seed, length=60):
    """A random walk: what it delivers, and which choices it had."""
    chance, net, seen = random.Random(seed), begin(nets).net, []
    for _ in range(length):
        some = nets.successors(net)
        if not some:
            break
        moves = [(move.kind, move.node, move.missed, move.deaf, broken) for move, _, broken in some]
        _, net, _ = some[chance.randrange(len(some))]
        seen.append((moves, sorted(nets.sets[net.got])))
    return seen


def test_what_is_tidied_away_is_looked_at_by_nobody():
    budget = MeshBudget(deaths=1, revivals=1, frames=2, acks=2, ticks=2)
    made = model("kite", offers=((3, 0), (2, 1)), budget=budget)
    untidy = mesh_net.Nets(made, mesh_local.Locals(made, neat=False))
    tidy = mesh_net.Nets(made)
    for seed in range(5):
        assert walk(tidy, seed) == walk(untidy, seed)
    small = model("line", offers=((2, 0),), budget=LOST_ACK)
    whole = mesh_net.Nets(small, mesh_local.Locals(small, neat=False))
    assert (
        mesh_search.explore(small).tally.states
        < mesh_search.explore(small, nets=whole).tally.states
    )


def test_walks_find_the_loop_too_and_stay_within_their_number():
    made = LOOPS[0][0]
    assert mesh_search.wander(made, 400, length=60).broken == mesh_local.BROKEN_ROUND
    calm = mesh_search.wander(replace(made, budget=NOTHING), 5)
    assert (calm.broken, calm.tally.ended, calm.tally.states) == (0, "walked", 5)


def test_a_search_ends_where_its_memory_does():
    made = model("line", offers=((2, 0),))
    found = mesh_search.explore(made, memory=1 << 20, live=False)
    assert found.tally.ended == "memory"
    assert mesh_search.explore(made, states=50, live=False).tally.ended == "limit"


def test_bounds_and_names():
    assert mesh_model.parse("line") == ((0, 1), (1, 2))
    for wrong in ("0-1", "0-1 2-3", "0-0 0-1 1-2", "a-b"):
        with pytest.raises(VerifyError):
            mesh_model.parse(wrong)
    with pytest.raises(VerifyError, match="should be NAME=NUMBER"):
        budget_of("dead=1", NOTHING)
    with pytest.raises(VerifyError, match="failover is one of"):
        mesh_model.parameters(model("line", "guess"))


def test_the_calm_future_is_played_once():
    nets = mesh_net.Nets(model("line", offers=((2, 0),), budget=NOTHING))
    fair, net = mesh_fair.Fair(nets), begin(nets).net
    assert fair.check(net) == 0
    offered = nets.offers(net)[0][1]
    assert fair.check(offered) == 0
    known = len(fair.ends)
    assert fair.check(nets.air(offered, 2)[0][1]) == 0
    assert len(fair.ends) == known
