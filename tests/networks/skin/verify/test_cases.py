"""What a case of the skin's explorer says of itself, as it is set by hand."""

import pytest

from innervate.networks.skin.verify import command, graphs, story
from innervate.networks.skin.verify.fair import Fair
from innervate.networks.skin.verify.system import ANY, Budget, SkinModel
from innervate.verify.errors import VerifyError
from innervate.verify.tally import Tally


def case(ended="complete", fair=None, told=None, left_out=0, **keys):
    model = SkinModel(graphs.parse("pair"), **keys)
    tally = Tally(states=5, expanded=4, generated=9, depth=3, wall_s=0.12345, ended=ended,
                  left_out=left_out)  # fmt: skip
    return command.SkinCase(model, "pc-1 1-2", tally, fair, told)


def fair(ended, starts=3, of=3, left_out=0):
    return Fair(40, starts, of, calm=2, rounds=7, played=21, left_out=left_out, ended=ended)


@pytest.mark.parametrize(("ended", "played", "is_complete", "is_broken"), [
    ("complete", None, True, False),
    ("limit", None, False, False),
    ("complete", fair("complete"), True, False),
    ("complete", fair("complete", starts=2), False, False),
    ("complete", fair("memory"), False, False),
    ("complete", fair("broken"), False, True),
    ("memory", fair("complete"), False, False),
])  # fmt: skip
def test_all_was_looked_at_if_both_ended_so_and_every_start_was_tried(
    ended, played, is_complete, is_broken
):
    made = case(ended, played)
    assert (made.is_complete, made.is_broken) == (is_complete, is_broken)


def test_who_has_a_story_is_broken_and_its_record_tells_it():
    told = story.Story("a ring", ["One."], graph=graphs.parse("pair"))
    made = case("broken", told=told, budget=Budget(ticks=ANY, loss=2), rule="paper")
    assert made.is_broken
    record = made.as_dict()
    assert record["budget"]["ticks"] == "any"
    assert record["budget"]["loss"] == 2
    del record["budget"]
    assert record == {
        "graph": "pc-1 1-2", "rule": "paper", "updates": made.model.updates, "states": 5,
        "expanded": 4, "generated": 9, "left_out": 0, "depth": 3, "wall_s": 0.123,
        "ended": "broken",
        "broken": "a ring", "story": ["One."], "fair": None,
    }  # fmt: skip


@pytest.mark.parametrize(("searched", "played"), [(0, 0), (3, 0), (0, 4), (3, 4)])
def test_not_all_was_looked_at_where_something_was_left_out_for_want_of_room(searched, played):
    made = case(fair=fair("complete", left_out=played), left_out=searched)
    assert made.is_complete == (searched + played == 0)
    assert made.as_dict()["left_out"] == searched + played


def test_a_record_says_that_routes_are_not_shortest_in_time():
    made = case(fair=fair("broken"))
    assert made.as_dict()["broken"] == "routes are not shortest after 40 fair rounds"
    assert made.as_dict()["story"] is None


def test_a_record_has_what_the_fair_schedule_came_to():
    record = case(fair=fair("complete")).as_dict()
    assert (record["broken"], record["story"]) == (None, None)
    assert record["fair"] == {
        "bound": 40, "rounds": 7, "starts": 3, "calm": 2, "played": 21, "ended": "complete",
    }  # fmt: skip


@pytest.mark.parametrize(("cells", "fits"), [(0, False), (1, True), (4, True), (5, False)])
def test_graphs_of_one_to_four_cells_are_all_that_there_are(cells, fits):
    if fits:
        assert {graph.cells for graph in command.graphs_of("all", cells)} == set(
            range(1, cells + 1)
        )
    else:
        with pytest.raises(VerifyError, match="must be 1 to 4"):
            command.graphs_of("all", cells)
    assert len(command.graphs_of("pair", cells)) == 1
