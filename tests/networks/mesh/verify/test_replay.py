"""A mesh's counterexample as a scenario: what is in it, and which loop a run of it ends with."""

import tomllib
from types import SimpleNamespace as Of

import numpy as np
import pytest

from innervate.networks.mesh.protocol import constants as const
from innervate.networks.mesh.verify import model as models
from innervate.networks.mesh.verify import net as nets
from innervate.networks.mesh.verify import replay
from innervate.networks.mesh.verify.replay import Loss

OFFERS = ((2, 0), (1, 2))


def story_of(*kinds, offers=OFFERS, ring=(1, 2), robot=-1):
    """A story of some events, each of node 1."""
    made = models.MeshModel(models.parse("line"), offers=offers)
    if robot >= 0:
        made = Of(robot=robot)
    path = [(Of(kind=kind, node=1), None, 0) for kind in kinds]
    return Of(found=Of(model=made, path=path), ring=list(ring), dest=0, lines=lambda: ["1. So."])


def test_messages_deaths_and_cuts_have_their_times():
    events = [(13_000_000, 'action = "kill"\nnode = 1'),
              (12_500_000, 'action = "cut"\nlink = [0, 1]')]  # fmt: skip
    told = tomllib.loads(replay._text(story_of(), 7, events))
    assert (told["seed"], told["nodes"], told["gateway"]) == (7, 3, 0)
    first, last = told["flow"]
    assert (first["from"], first["to"], first["start_s"], first["count"]) == (2, 0, 12.0, 1)
    assert (last["from"], last["to"], last["start_s"]) == (1, 2, 14.0)
    assert (last["count"], last["every_s"]) == (replay.MORE, replay.APART_S)
    what = [(one["at_s"], one["action"]) for one in told["event"]]
    assert what == [(12.5, "cut"), (13.0, "kill")]
    # The last of many messages has gone ten seconds before the end.
    assert told["duration_s"] == 12.0 + 2.0 * (len(OFFERS) + replay.MORE) + 10.0


@pytest.mark.parametrize(("kinds", "at_s"), [
    ((nets.DIE,), [11.0]), ((nets.OFFER, nets.DIE), [13.0]),
    ((nets.OFFER, nets.AIR, nets.OFFER, nets.DIE, nets.FIRE), [15.0]),
    ((nets.DIE, nets.OFFER, nets.DIE), [11.0, 13.0]), ((nets.OFFER, nets.AIR), []),
])  # fmt: skip
def test_nodes_die_halfway_between_two_messages(kinds, at_s):
    found = replay._deaths(story_of(*kinds))
    assert found == [(round(1e6 * at), 'action = "kill"\nnode = 1') for at in at_s]


ROWS = [  # node, link_dst, kind, time
    (2, 1, const.DATA, 13_999_999), (2, 1, const.DATA, 14_000_000), (2, 1, const.DATA, 15_000_000),
    (1, 2, const.DATA, 15_100_000), (2, 0, const.DATA, 15_200_000), (2, 1, const.ACK, 15_300_000),
    (1, 0, const.DATA, 15_400_000),
]  # fmt: skip


def test_frames_like_the_lost_one_are_of_its_sender_to_the_same_node_since_its_message(monkeypatch):
    kinds = [("node", "i8"), ("link_dst", "i8"), ("kind", "i8"), ("time", "i8"), ("end", "i8")]
    sent = np.array([(*row, row[3] + 900) for row in ROWS], kinds)
    monkeypatch.setattr(replay, "simulate", lambda plan: Of(sent=sent))
    text = replay._text(story_of(), 1, [])
    like = replay._transmissions(text, Loss(2, 2, 1, const.DATA, 0))
    assert like == [(14_000_000, 14_000_900), (15_000_000, 15_000_900)]
    assert len(replay._transmissions(text, Loss(1, 2, 1, const.DATA, 0))) == 3
    assert replay._transmissions(text, Loss(2, 2, 1, const.ACK, 0)) == [(15_300_000, 15_300_900)]


# Next hops of three nodes to 0, 1 and 2, in both banks of each; 255 is nobody.
TABLES = [
    (0, [0, 1, 1, 9, 9, 9]), (1, [9, 9, 9, 2, 1, 2]), (0, [1, 255, 2, 9, 9, 9]),
]  # fmt: skip


@pytest.mark.parametrize(("dest", "ring"), [(0, [1, 2]), (1, []), (2, [])])
def test_a_loop_is_two_nodes_that_have_each_other_in_the_tables_in_force(dest, ring, monkeypatch):
    nodes = [Of(bank=bank, next=table) for bank, table in TABLES]
    result = Of(plan=Of(params={"width": 3}, nodes=3), world=Of(nodes=nodes))
    monkeypatch.setattr(replay, "simulate", lambda plan: result)
    assert replay.loop_of(replay._text(story_of(), 1, []), dest) == ring


def test_of_all_seeds_the_first_is_written_whose_run_closes_the_same_loop(monkeypatch):
    monkeypatch.setattr(replay, "_timed", lambda story, seed: "" if seed == 1 else f"seed {seed}")
    loops = {"seed 2": [], "seed 3": [0, 1], "seed 4": [1, 2], "seed 5": [1, 2]}
    monkeypatch.setattr(replay, "loop_of", lambda text, dest: loops.get(text, []))
    assert replay.write(story_of(ring=(2, 1))) == "# 1. So.\nseed 4"
    assert replay.write(story_of(ring=(0, 2))) == ""
    assert replay.write(story_of(ring=())) == ""
    assert replay.write(story_of(robot=0)) == ""
