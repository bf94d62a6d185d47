"""The mesh's figures and claims, in quick mode; the bars with real sizes at the end."""

import numpy as np
import pytest

from innervate.networks.mesh import papers as mesh
from innervate.networks.mesh.papers import FIGURES, alarms, bars, gateway, scale, stretch
from innervate.networks.mesh.papers.bars import wire_bytes
from innervate.networks.mesh.papers.testbed import GATEWAY, MeshTestbed, dying, kill, send_rounds
from innervate.papers import main
from innervate.papers.experiment import FAILS, Measured
from innervate.plot import style
from tests.fixtures.papers import must, read, wrong
from tests.networks.mesh.papers.test_edges import results
from tests.plot.labels import legends_over_panels, over_panels
from tests.plot.self_contained import check_paper

# Figure and words of its claims: those that have to hold, and those that must not.
MUST_HOLD = (
    ("bars", "discovery recall"),
    ("bars", "every node with tables"),
    ("bars", "tables complete"),
    ("bars", "unknown dead, search"),
    ("bars", "alarms with 8 dead: delivered"),
    ("bars", "latency, 99 %"),
    ("bars", "overrun at 1 m/s"),
    ("bars", "state of a node"),
    ("bars", "own rule loses"),
    ("stretch", "discovery list"),
    ("stretch", "alternate that cannot loop"),
    ("failures", "alternates, then a search"),
    ("failures", "than by RSSI alone"),
    ("lossy", "search"),
    ("lossy", "graph"),
    ("alarms", "frames sent up to three times"),
    ("alarms", ": all alarms"),
    ("scale", "tables leave half of the channel"),
    ("scale", "take less of the channel"),
    ("versions", "alternates alone"),
    ("versions", "with the search"),
)
MUST_FAIL = (
    ("recall", "(tree)"),
    ("recall", "(each)"),
    ("recall", "at once"),
    ("recall", "respond to every request"),
    ("recall", "the first or the best"),
    ("stretch", "discovery tree"),
    ("stretch", "discovery each"),
    ("failures", "nobody is dead"),
    ("failures", "packets after the first"),
    ("failures", "the first packet arrives"),
    ("failures", "than by chance"),
    ("failures", "help every rule"),
    ("lossy", "to the letter, while nobody dies"),
    ("alarms", "nobody dead, to the letter"),
    ("alarms", "unknown dead, to the letter"),
    ("gateway", "outlives the gateway"),
)


@pytest.mark.parametrize("name", FIGURES)
def test_no_legend_lies_over_a_panel(mesh_made, name):
    assert legends_over_panels(mesh_made.folder, name) == []


def test_a_legend_in_a_panel_is_noticed():
    figure, (ax,) = style.panels(2, 2)
    ax.plot([0, 1], label="a line")
    ax.legend()
    figure.draw_without_rendering()
    assert over_panels(figure) == ["a line"]


@must(MUST_HOLD, MUST_FAIL)
def test_what_holds_and_what_does_not(mesh_made, begins, name, words):
    others = wrong(mesh_made, begins, name, words)
    if words == ": all alarms":  # routed alone it may be late: that is why there is a flood
        others = [claim for claim in others if "flooded" in claim.claim]
    assert others == []


def test_with_one_death_more_the_same_die_and_one_more():
    plan = MeshTestbed(nodes=8, degree=4).plan(3)
    four, five = dying(plan, 4), dying(plan, 5)
    assert five[:4] == four
    assert len(set(five)) == 5
    assert GATEWAY not in dying(plan, 7)
    kill(plan, five, 1_000_000)
    assert [fault.node for fault in plan.faults] == five
    assert {fault.at_us for fault in plan.faults} == {1_000_000}


def test_everyone_sends_once_a_round_and_never_to_itself():
    plan = MeshTestbed(nodes=8, degree=4).plan(1)
    send_rounds(plan, [1, 3, 5, 7], 2, 1_000_000, 400_000)
    for k in range(2):
        mine = [offer for offer in plan.offers if offer.flow == k]
        assert sorted(offer.node for offer in mine) == [1, 3, 5, 7]
        assert all(offer.dest in (1, 3, 5, 7) and offer.dest != offer.node for offer in mine)
        assert all(0 <= offer.at_us - 1_000_000 - 400_000 * k < 300_000 for offer in mine)


@pytest.mark.parametrize("seed", range(1, 9))
def test_a_robot_walks_straight_out(seed):
    (start, end), start_s = alarms.walk(seed)
    inside = [alarms.LOW_M < value < alarms.HIGH_M for value in start]
    outside = [alarms.LOW_M <= value <= alarms.HIGH_M for value in end]
    assert all(inside)
    assert sorted(outside) == [False, True]
    assert 0 <= start_s + alarms.INSIDE_M - alarms.CROSSED_S < 1


def test_a_crossing_is_measured():
    run = alarms.measure(alarms.BOTH, 8, 1)
    assert run["joined"]
    assert run["came"]
    assert 0 < run["ms"] <= run["flood_ms"]
    assert 0 < run["overrun_m"] <= (20 + run["ms"]) / 1000 + 0.001


def test_whose_neighbours_are_all_dead_is_not_connected():
    plan = alarms.make_testbed(alarms.BOTH, 1).plan(1)
    everyone = [node for node in range(plan.nodes) if node not in (GATEWAY, alarms.ROBOT)]
    at_us = round((alarms.walk(1)[1] + alarms.INSIDE_M) * 1e6)
    assert alarms._joined(plan, [], at_us)
    near = alarms._joined(plan, everyone, at_us)
    assert near == (np.hypot(*np.subtract(plan.positions_cm[0], plan.positions_cm[29])) < 2000)


def test_following_tables():
    ways = [[255, 1, 1], [0, 255, 2], [1, 1, 255]]
    assert stretch._hops(ways, 0, 2) == 2
    assert stretch._hops([[255, 1, 1], [0, 255, 0], [1, 1, 255]], 0, 2) == 0
    assert stretch._hops([[255, 1, 255], [0, 255, 0], [1, 1, 255]], 0, 2) == 0


@pytest.mark.parametrize(
    ("way", "other", "kind"), [(1, 2, 0), (1, 255, 3), (1, 4, 2), (2, 1, 0)]
)  # fmt: skip
def test_kinds_of_alternates(way, other, kind):
    # A square 0-1-3-2 with a tail 4 at 0: from 0 to 3 over 1 or 2; 4 would only come back.
    far = [[0, 1, 1, 2, 1], [1, 0, 2, 1, 2], [1, 2, 0, 1, 2], [2, 1, 1, 0, 3], [1, 2, 2, 3, 0]]
    assert stretch._kind(far, 0, 3, way, other) == kind


def test_sizes_at_which_nodes_got_no_table_are_drawn_hollow_and_told_in_the_table():
    whole = results("scale")
    tried = scale.point(scale.RADIOS[0], "tables", 30, True)
    whole[tried.key] |= {"with_tables": [28], "unknown": [1], "tables_s": [None]}
    got = Measured(whole, True)
    fast, _ = scale.draw(got).axes
    (hollow,) = (line for line in fast.lines if line.get_markerfacecolor() == "white")
    assert hollow.get_xdata() == [30]
    assert hollow.get_label() == "tables, not all got theirs"
    (line,) = (line for line in fast.lines if line.get_label() == "tables")
    assert 30 not in line.get_xdata()
    (sheet,) = scale.sheets(got)
    assert [row[:3] + row[-1:] for row in sheet.rows if "failed" in row[-1]] == [
        ("250k", "tables", "30", "failed: nodes in 1 of 1 networks got no table, 2 of 30")
    ]
    assert {row[-1] for row in sheet.rows if row[1] == "table-free"} == {"there are no tables"}


def test_a_stretch_of_tables_that_do_not_connect_all_is_drawn_hollow():
    whole = results("stretch")
    whole[stretch.point("tree", 8, True).key]["broken"] = [2]
    left, _ = stretch.draw(Measured(whole, True)).axes
    hollow = [line for line in left.lines if line.get_markerfacecolor() == "white"]
    assert [line.get_markevery() for line in hollow] == [[1], [], []]


def test_nothing_is_said_of_sizes_that_were_not_run():
    tried = [scale.Size(n, share, [0], 0, 1.0) for n, share in ((10, 0.1), (30, 0.5), (70, 0.6))]
    assert scale._reached(tried) == "half is passed between N = 30 and 70"
    assert scale._reached(tried[:2]) == "less than half up to N = 30, the most that was run"


def test_state_grows_with_the_class_only():
    assert wire_bytes(20) == wire_bytes(32) < wire_bytes(33) == wire_bytes(64) < wire_bytes(65)


def test_what_never_came_is_slowest():
    crossings = {"joined": [True, True, False, True], "ms": [3.0, None, 2.0, 1.0]}
    taken = {"takeover_s": [None, 26.0]}
    one, other = alarms.point(alarms.BOTH, 8, True), gateway.point(gateway.ONE, True)
    got = Measured({one.key: crossings, other.key: taken}, True)
    assert alarms.told(got, alarms.BOTH, 8)["ms"].tolist() == [3.0, np.inf, 1.0]
    assert gateway.takeovers(got, gateway.ONE) == [26.0, np.inf]


def test_where_nothing_of_what_is_allowed_was_used_the_figure_says_so():
    got = Measured(results("bars"), True)
    unused = [row for row, bar in enumerate(bars.bars(got)) if bar.used == 0]
    (ax,) = bars.draw(got).axes
    assert [
        text.get_position()[1] for text in ax.texts if text.get_text() == "nothing amiss"
    ] == unused
    assert 0 < len(unused) < len(ax.patches)


@pytest.mark.slow
def test_what_was_asked_for_in_full(tmp_path):
    main("mesh", tmp_path, only=["bars"])
    (claims,) = read(tmp_path, False, ["bars"], mesh).claims.values()
    assert [claim for claim in claims if claim.verdict == FAILS] == []


def test_the_page_needs_nothing_else_and_can_be_had_again(mesh_made):
    check_paper(mesh_made, "mesh", "innervate papers mesh --quick")
