"""Places of nodes and of their names on a drawing, to a part of a pixel."""

import math
from itertools import combinations, pairwise
from types import SimpleNamespace

import pytest

from innervate import scenario
from innervate.networks.mesh.plot.sheet import Labels, Sheet, laid_out, shortened

MARGIN = 34  # px round everything
CHARACTER, STRONG, LINE = 6.6, 7.6, 12  # px that names at 11 px take


def planned(places, more=""):
    nodes = "".join(f'[[node]]\nname = "n{i}"\nx_m = {x}\ny_m = {y}\n'
                    for i, (x, y) in enumerate(places))  # fmt: skip
    return scenario.plan(scenario.loads(f"kind = 'mesh'\nradio.reach_m = 60\n{nodes}{more}"))


def grid(count, step_m=10.0):
    wide = math.ceil(count**0.5)
    return [(step_m * (i % wide), step_m * (i // wide)) for i in range(count)]


FENCE = "[fence]\npolygon = [[-40, -30], [90, -30], [90, 70], [-40, 70]]\n"


@pytest.mark.parametrize(("places", "more", "low", "high"), [
    ([(0, 0), (30, 0), (30, 10)], "", (0, 0), (30, 10)),
    ([(0, 0), (5, 40)], "", (0, 0), (5, 40)),
    ([(0, 0), (30, 20)], FENCE, (-40, -30), (90, 70)),
])  # fmt: skip
def test_a_map_is_as_large_as_fits_with_a_margin_and_north_is_up(places, more, low, high):
    sheet = Sheet(planned(places, more), 760, 660)
    wide, tall = 100 * (high[0] - low[0]), 100 * (high[1] - low[1])
    scale = min((760 - 2 * MARGIN) / wide, (660 - 2 * MARGIN) / tall)
    assert sheet.metres
    assert (sheet.scale, sheet.width) == pytest.approx((scale, 760))
    assert sheet.height == pytest.approx(tall * scale + 2 * MARGIN + 16)  # 16: the bar of metres
    left = (760 - wide * scale) / 2
    for node, (x, y) in enumerate(places):
        there = (left + scale * 100 * (x - low[0]), MARGIN + scale * 100 * (high[1] - y))
        assert sheet.node(node) == pytest.approx(there)


def test_where_a_robot_walks_is_on_the_map():
    walk = '[[robot]]\nnode = "n1"\nwaypoints = [[10, 0], [100, 50]]\nspeed_mps = 5.0\n'
    sheet = Sheet(planned([(0, 0), (10, 0)], walk), 760, 660)
    assert sheet.scale == pytest.approx((760 - 2 * MARGIN) / 10_000)
    assert sheet.of_cm((10_000, 5_000)) == pytest.approx((760 - MARGIN, MARGIN))


def test_a_node_that_is_alone_lies_amidst_some_metres():
    sheet = Sheet(planned([(3, 4)]), 760, 660)
    assert sheet.node(0) == pytest.approx((380, MARGIN + 100 * sheet.scale))
    assert 760 / sheet.scale == pytest.approx(1098, abs=1)  # cm


@pytest.mark.parametrize(("count", "dot"), [(100, 5.0), (101, 3.5)])
def test_nodes_of_a_large_mesh_are_small(count, dot):
    assert Sheet(planned(grid(count))).dot == dot


PAIRS_M = 80.0  # from the first pair to the last


@pytest.mark.parametrize(("apart_m", "more", "metres"), [
    (0.81, "", True), (0.79, "", False), (0.01, FENCE, True),
])  # fmt: skip
def test_nodes_that_would_lie_on_each_other_are_drawn_by_who_hears_whom(apart_m, more, metres):
    """True places only where most are 7.5 px from the next, on a drawing 760 px wide."""
    assert (apart_m * 760 / (PAIRS_M + apart_m) > 7.5) == (metres and not more)
    places = [(20.0 * i + dx, 0.0) for i in range(5) for dx in (0.0, apart_m)]
    sheet = Sheet(planned(places, more))
    assert sheet.metres == metres
    if not metres:
        away = [math.dist(a, b) for a, b in combinations(sheet.points.tolist(), 2)]
        assert min(away) > 7.5


def test_hops_apart_nodes_without_places_are_apart_on_the_drawing():
    """A chain is drawn as one: whoever is more hops away is farther, and neighbours are near."""
    links = "".join(f"[[link]]\na = {i}\nb = {i + 1}\n" for i in range(5))
    plan = scenario.plan(scenario.loads(f"kind = 'mesh'\nnodes = 6\n{links}"))
    places = laid_out(plan)
    away = [math.dist(places[0], place) for place in places]
    assert away == sorted(away)
    steps = [math.dist(a, b) for a, b in pairwise(places)]
    assert min(steps) > 80
    assert max(steps) < 150


def test_two_nodes_lie_side_by_side_and_parts_of_a_mesh_apart():
    two = scenario.plan(scenario.loads("kind = 'mesh'\nnodes = 2\n[[link]]\na = 0\nb = 1\n"))
    assert laid_out(two).tolist() == [[0, 0], [100, 0]]
    places = laid_out(SimpleNamespace(nodes=4, good=[(0, 1), (2, 3)]))
    within = max(math.dist(places[0], places[1]), math.dist(places[2], places[3]))
    assert min(math.dist(places[a], places[b]) for a in (0, 1) for b in (2, 3)) > 1.5 * within


@pytest.mark.parametrize(("end", "gap", "short"), [
    ((30, 40), 5, ((3, 4), (27, 36))), ((-30, -40), 5, ((-3, -4), (-27, -36))),
    ((3, 4), 5, ((1.2, 1.6), (1.8, 2.4))), ((0, 0), 5, ((0, 0), (0, 0))),
])  # fmt: skip
def test_a_line_ends_outside_of_the_dots_and_never_turns_round(end, gap, short):
    start, stop = shortened((0, 0), end, gap)
    assert start == pytest.approx(short[0])
    assert stop == pytest.approx(short[1])


def box(place, anchor, words, strong=False):
    """(low x, low y, high x, high y) of a name at a place."""
    (x, y), long = place, (STRONG if strong else CHARACTER) * len(words)
    low = {"start": x, "middle": x - long / 2, "end": x - long}[anchor]
    return low, y - LINE + 2, low + long, y + 2


def overlap(a, b):
    return a[0] < b[2] and b[0] < a[2] and a[1] < b[3] and b[1] < a[3]


BESIDE = [((110, 104), "start"), ((90, 104), "end"), ((100, 90), "middle"),
          ((100, 119), "middle"), ((107.5, 92.5), "start"), ((107.5, 115.5), "start"),
          ((92.5, 92.5), "end"), ((92.5, 115.5), "end")]  # fmt: skip


def free(taken, strong):
    """Places beside a node at (100, 100) where the name would lie on none of the others."""
    boxes = [box(*place, "node 1", strong) for place in BESIDE]
    return [place for place, one in zip(BESIDE, boxes, strict=True)
            if not any(overlap(one, other) for other in taken)]  # fmt: skip


@pytest.mark.parametrize("strong", [False, True])
def test_a_name_takes_the_first_place_that_is_free(strong):
    taken = []
    labels = Labels(200, 200)
    while (put := labels.put((100, 100), "node 1", 10, strong)) is not None:
        assert put == free(taken, strong)[0]
        taken.append(box(*put, "node 1", strong))
    assert len(taken) >= 4
    assert free(taken, strong) == []


@pytest.mark.parametrize(("strong", "x", "anchor"), [
    (False, 122, "start"), (False, 123, "end"), (True, 112, "start"), (True, 113, "end"),
])  # fmt: skip
def test_strong_letters_take_more_room(strong, x, anchor):
    assert Labels(200, 200).put((x, 100), "a" * 10, 10, strong)[1] == anchor


@pytest.mark.parametrize(("y", "anchor"), [(192, "start"), (193, "middle")])
def test_names_stay_above_the_lower_edge(y, anchor):
    assert Labels(200, 200).put((100, y), "a", 10)[1] == anchor


@pytest.mark.parametrize(("words", "centre", "anchor"), [
    ("a", (100, 100), "start"), ("a", (180, 100), "start"), ("a", (182, 100), "end"),
    ("long name", (60, 100), "start"), ("x" * 24, (100, 100), "middle"),
    ("x" * 30, (100, 100), None),
])  # fmt: skip
def test_a_name_stays_on_the_drawing(words, centre, anchor):
    put = Labels(200, 200).put(centre, words, 10)
    assert (put and put[1]) == anchor
    if put:
        low_x, low_y, high_x, high_y = box(*put, words)
        assert min(low_x, low_y) >= 2
        assert max(high_x, high_y) <= 198


def test_nothing_is_written_on_nodes_and_lines():
    labels = Labels(400, 200)
    labels.block((120, 100), 6)
    assert labels.put((100, 100), "node", 10) == ((90, 104), "end")
    lined = Labels(400, 200)
    lined.block_line([(0, 100), (400, 100)])
    for x in range(60, 360, 60):
        assert lined.put((x, 100), "node", 10) == ((x, 90), "middle")  # above it


@pytest.mark.parametrize(("lines", "anchor"), [
    ([], "start"), ([((100, 100), (200, 100))], "end"),
    ([((100, 100), (200, 100)), ((0, 100), (100, 100))], "middle"),
    ([((0, 0), (200, 0))], "start"),  # far from here
    ([((x, 0), (x, 400)) for x in (110, 112, 90, 100, 101)], "end"),  # one; two elsewhere
])  # fmt: skip
def test_a_name_lies_on_as_few_lines_as_it_can(lines, anchor):
    names = Labels(400, 400)
    names.avoid(lines)
    assert names.put((100, 100), "n1", 9.0)[1] == anchor
