"""A mesh's counterexample in words, and which of its frames a scenario has to lose."""

import random
from types import SimpleNamespace

import pytest

from innervate.networks.mesh.protocol import constants as const
from innervate.networks.mesh.verify import command, fuzz, local, replay, story
from innervate.networks.mesh.verify import model as models
from innervate.networks.mesh.verify import net as nets
from innervate.networks.mesh.verify.command import MeshWanted
from innervate.networks.mesh.verify.model import MeshBudget
from innervate.networks.mesh.verify.net import DEAD
from innervate.networks.mesh.verify.replay import Loss

TO_2 = SimpleNamespace(kind=const.DATA, link_dst=2, path=[0, 1], body=[4], flags=const.ACK_WANTED)
TO_ALL = SimpleNamespace(kind=const.REQUEST, link_dst=const.ALL, path=[0], body=[], flags=0)
POSITION = SimpleNamespace(kind=99, link_dst=0, path=[1], body=[], flags=0)


class Locals:
    """Node states whose number is their next hop to each recipient; -2 is none."""

    packets = (TO_2, TO_ALL, POSITION)

    def field(self, number, name):
        if name == "bank":
            return 1
        hops = [255 if hop < 0 else hop for hop in HOPS[number]]
        return [7] * len(hops) + hops


HOPS = {10: [0, 1, 2], 11: [-1, 1, 0], 12: [1, 0, 2], 13: [0, 0, -1]}
NETS = SimpleNamespace(n=3, locals=Locals(), model=SimpleNamespace(offers=((0, 2), (1, 0))))


def net(*numbers):
    return SimpleNamespace(nodes=numbers)


def move(kind, node=1, frame=0, missed=(), deaf=False):
    return SimpleNamespace(kind=kind, node=node, frame=frame, missed=missed, deaf=deaf)


CALM = net(10, 11, 12)


@pytest.mark.parametrize(
    ("event", "words"),
    [
        (move(nets.DIE), "node 1 dies"),
        (move(nets.REVIVE, 2), "node 2 is switched on again, its memory lost"),
        (move(nets.SWITCH_ON, 0), "node 0 is switched on"),
        (move(nets.OUTSIDE), "node 1 finds itself outside the fence"),
        (move(nets.OFFER, frame=1), "node 1 is given message 2 for node 0"),
        (move(nets.FIRE, frame=const.TICK), "node 1 has its beat"),
        (move(nets.AIR), "node 1 sends message 5 to node 2 (path 0-1)"),
        (move(nets.AIR, missed=(2,)),
         "node 1 sends message 5 to node 2 (path 0-1), but it is lost"),
        (move(nets.AIR, deaf=True),
         "node 1 sends message 5 to node 2 (path 0-1), which receives it, but the ack is lost"),
        (move(nets.AIR, frame=1), "node 1 sends a discovery request to all"),
        (move(nets.AIR, frame=1, missed=(0, 2)),
         "node 1 sends a discovery request to all; node 0, node 2 does not receive it"),
        (move(nets.AIR, frame=2), "node 1 sends a packet to node 0 (path 1)"),
    ],
)  # fmt: skip
def test_each_event_in_a_sentence(event, words):
    assert story._sentence(NETS, event, CALM, CALM) == words


def test_what_tables_say_now_that_they_did_not():
    after = net(10, 13, DEAD)
    assert story._sentence(NETS, move(nets.FIRE, frame=const.TX), CALM, after) == (
        "node 1 has waited; node 1 has node 0 in its table for node 0 now; "
        "node 1 has node 0 in its table for node 1 now; node 1 has nobody in its table "
        "for node 2 now"
    )
    dead = story._sentence(NETS, move(nets.AIR), net(10, 11, DEAD), net(10, 11, DEAD))
    assert dead.endswith("(path 0-1), which is dead")
    assert story.next_hops(NETS, net(10, 11, DEAD), 0) == [0, -1, -1]
    assert story.next_hops(NETS, CALM, 2) == [2, 0, 2]


@pytest.mark.parametrize(
    ("hops", "found"),
    [([1, 0], [0, 1]), ([-1, 2, 1], [1, 2]), ([0, 1], []), ([1, 2, 0], []), ([], []),
     ([-1, -1], []), ([5, 0], [])],
)  # fmt: skip
def test_two_that_have_each_other_in_their_tables(hops, found):
    assert story.ring(hops) == found


@pytest.mark.parametrize(
    ("event", "after", "sent", "lost"),
    [
        (move(nets.AIR), CALM, (1, 2), ()), (move(nets.AIR, missed=(2,)), CALM, (), (1, 2)),
        (move(nets.AIR), net(10, 11, DEAD), (), (1, 2)),
        (move(nets.AIR, deaf=True), CALM, (1, 2), (2, 1)),
        (move(nets.AIR, frame=1), CALM, (), ()), (move(nets.DIE), CALM, (), ()),
    ],
)  # fmt: skip
def test_what_a_drawing_shows_of_an_event(event, after, sent, lost):
    scene = story._scene(NETS, 2, event, after)
    assert (scene.sent, scene.lost, scene.actor) == (sent, lost, 1)
    assert scene.dead == [node for node, number in enumerate(after.nodes) if number == DEAD]
    assert scene.hops == story.next_hops(NETS, after, 2)


def told(broken, *path):
    found = SimpleNamespace(
        broken=broken, start=CALM, nets=NETS, path=path,
        model=SimpleNamespace(offers=((0, 2),), nodes=3),
    )  # fmt: skip
    return story.tell(found)


def test_a_story_says_what_is_broken_and_between_whom_a_packet_goes():
    calm = told(local.BROKEN_UNHEARD, (move(nets.DIE), CALM, 0))
    assert calm.sentences == ["Node 1 dies."]
    assert calm.title == story.TITLES[local.BROKEN_UNHEARD] + ", though nothing fails any more"
    assert (calm.dest, calm.ring) == (2, [])
    assert told(local.BROKEN_TWICE, (move(nets.DIE), CALM, 0)).title == (
        "a packet is delivered twice"
    )
    assert told(local.BROKEN_RANGE).scenes == []


@pytest.mark.parametrize(("dest", "shown"), [(1, 1), (2, 2), (3, 0), (254, 0)])
def test_a_packet_that_goes_round_is_shown_on_its_way_to_its_recipient(dest, shown):
    """Or to node 0 where that is who leads, whoever it is."""
    gone = SimpleNamespace(kind=const.DATA, path=[0, 1, 0, 1], path_len=4, dest=dest)
    states = {11: SimpleNamespace(handed=story.NONE), 12: SimpleNamespace(handed=0)}
    found = SimpleNamespace(
        broken=local.BROKEN_ROUND, path=[(move(nets.AIR), net(DEAD, 11, 12), 0)],
        nets=SimpleNamespace(locals=SimpleNamespace(states=states, packets=[gone])),
        model=SimpleNamespace(nodes=3, offers=((0, 1),)),
    )  # fmt: skip
    assert story._dest(found) == shown


def losses(*moves):
    found = SimpleNamespace(nets=NETS, path=[(one, None, 0) for one in moves])
    return replay._losses(SimpleNamespace(found=found))


def test_frames_and_acks_that_a_story_loses_are_counted_from_their_message_on():
    air, lost, deaf = move(nets.AIR), move(nets.AIR, missed=(2,)), move(nets.AIR, deaf=True)
    offer = move(nets.OFFER)
    assert losses(air, offer, air) == []
    assert losses(offer, lost) == [Loss(1, 1, 2, const.DATA, 0)]
    assert losses(offer, air, lost, deaf) == [
        Loss(1, 1, 2, const.DATA, 1), Loss(1, 2, 1, const.ACK, 1)]  # fmt: skip
    assert losses(offer, air, offer, lost) == [Loss(2, 1, 2, const.DATA, 0)]


@pytest.mark.parametrize(("nth", "found"), [
    (0, [(9, "cut"), (21, "restore")]), (1, [(29, "cut"), (41, "restore")]), (2, None),
])  # fmt: skip
def test_a_loss_is_a_cut_for_as_long_as_its_frame_is_on_the_air(nth, found, monkeypatch):
    told = []
    monkeypatch.setattr(replay, "_deaths", lambda story: [])
    monkeypatch.setattr(replay, "_losses", lambda story: [Loss(1, 2, 1, const.DATA, nth)])
    monkeypatch.setattr(replay, "_transmissions", lambda text, loss: [(10, 20), (30, 40)])
    monkeypatch.setattr(replay, "_text", lambda story, seed, events: told.append(events) or "it")
    assert replay._timed(None, 1) == ("it" if found else "")
    wanted = [(at, f'action = "{what}"\nlink = [1, 2]') for at, what in found or ()]
    assert told[-1] == wanted


ASKS = "gateways that are asked"


def test_what_is_explored_if_nobody_says_and_on_links_of_ones_own():
    found = [
        (name, models_.failover, models_.links) for name, models_ in command.models(MeshWanted())
    ]
    shapes = [models.parse(shape) for shape in ("line", "triangle", "square")]
    messages = [("a message", "search", links) for links in shapes]
    more = [(name, "search", shapes[0]) for name in ("an alarm", "gateways", ASKS)]
    assert found == [*messages, *more, *(("a message", "graph", links) for links in shapes)]
    links = ((0, 1), (1, 2), (2, 3))
    own = list(command.models(MeshWanted(("search", "random"), links, "deaths=2")))
    assert [name for name, _ in own] == ["a message", "an alarm", "gateways", ASKS, "two messages"]
    assert {one.links for _, one in own} == {links}
    message, alarm, gateways, asked, two = (one for _, one in own)
    assert message.offers == ((3, 0),)
    assert (alarm.robot, gateways.standby, gateways.beats) == (3, (3,), 6)
    assert (asked.standby, asked.beats) == ((3,), 3)
    asks = [models.parameters(one)["guard_us"] for one in (gateways, asked)]
    assert asks == [0, 100_000]
    assert [one.budget.deaths for one in (message, alarm, gateways, asked, two)] == [2] * 5
    assert message.budget == MeshBudget(deaths=2, frames=0, acks=1)
    assert command.text_of(links) == "0-1 1-2 2-3"


def test_smaller_meshes_are_smaller_one_thing_at_a_time():
    seen = set()
    for seed in range(12):
        mesh = fuzz.drawn(random.Random(seed), seed)
        mesh["standby"] = mesh["standby"] or [1, 2]
        for one in fuzz.smaller(mesh):
            changed = {key for key in mesh if one.get(key) != mesh[key]}
            assert changed
            seen |= changed
            if changed == {"flow"}:
                many = [sum(flow["count"] for flow in made["flow"]) for made in (one, mesh)]
                assert many[0] < many[1]
                assert one["flow"]
            if changed == {"standby"}:
                assert set(one["standby"]) < set(mesh["standby"])
            if changed == {"nodes"}:
                assert one["nodes"] in (None, mesh["nodes"] - 1)
            if changed == {"duration_s"}:
                assert one.get("duration_s", 0.0) < mesh["duration_s"]
            if "robot" in changed:
                assert "fence" in changed or "fence" not in one or "robot" not in one
    assert seen >= {"flow", "standby", "nodes", "duration_s", "robot", "fence"}
