"""Live nodes run by the numbers of the simulator's profile "ip", but for what a machine is."""

import pytest

from innervate import scenario
from innervate.live.errors import LiveError
from innervate.networks.mesh.live.parameters import OURS, fence_parameters, mesh_parameters
from innervate.networks.mesh.protocol.constants import TREE
from innervate.networks.mesh.protocol.fields import POINTS

# [mesh 5] and docs/live.md: waits for acks follow the round trips; a machine has room for more
# packets than a board, and several frames go in one datagram.
LIVE = {"ack_adapt": 1, "hop_frames": 16, "gather": 1, "queue": 48, "kept": 32}
FENCE = {"clear_m": 0.2, "predict_s": 0.5, "polygon": [[0, 0], [9, 0], [9, 9]]}


def simulated(**more):
    tables = {"kind": "mesh", "nodes": 3, "radio": {"profile": "ip"}, **more}
    return scenario.plan(scenario.from_dict(tables)).params


@pytest.mark.parametrize("name", sorted(mesh_parameters(3, {}).keys() - set(OURS) - {"places"}))
def test_a_number_is_that_of_the_simulated_network(name):
    ours = mesh_parameters(3, {})[name]
    if name in ("clear_margin", "predict_ms", "lost", "instances", "flood", "unit_cm"):
        assert ours == simulated(fence=FENCE)[name]
    elif name == "dead":  # a live node does not know whether others stand by
        assert ours == simulated(standby=[1])[name]
    else:
        assert ours == LIVE.get(name, simulated()[name])


@pytest.mark.parametrize(("changes", "faint"), [
    ({}, -92), ({"discovery": TREE}, -128), ({"min_rssi": -80}, -79), ({"min_rssi": 127}, 127),
    ({"discovery": TREE, "faint": -92}, -92), ({"faint": -128}, -128),
])  # fmt: skip
def test_the_first_uplink_or_the_best_as_in_a_scenario_that_does_not_say(changes, faint):
    assert mesh_parameters(3, changes)["faint"] == faint


@pytest.mark.parametrize(
    ("nodes", "width"), [(2, 32), (32, 32), (33, 64), (64, 64), (65, 128), (128, 128), (129, 254)]
)
def test_all_others_may_be_neighbours(nodes, width):
    made = mesh_parameters(nodes, {})
    assert (made["width"], made["places"]) == (width, width)
    assert (made["nodes"], made["points"], set(made["px"])) == (nodes, 0, {0})


@pytest.mark.parametrize(("changes", "words"), [
    ({"e2e_us": 1}, "e2e_us"), ({"nodes": 4}, "nodes"), ({"px": 1}, "px"), ({"no": 1}, "no"),
])  # fmt: skip
def test_what_is_to_be_different_is_known_and_in_its_range(changes, words):
    with pytest.raises(LiveError, match=f"^here.*{words}"):
        mesh_parameters(3, changes, "here")
    assert mesh_parameters(3, {"e2e_us": 1000})["e2e_us"] == 1000


def square(low, high):
    return [(low, low), (high, low), (high, high), (low, high)]


def test_a_fence_and_its_holes_are_rings_in_one_table():
    """Each corner has the place of the next one, and the last that of its ring's first."""
    rings = [square(0, 900), square(100, 200), [(300, 300), (400, 300), (400, 500)]]
    made = fence_parameters(rings)
    assert made["points"] == 11
    found, at = [], 0
    while at < made["points"]:
        ring, place = [], at
        while not ring or place != at:
            ring.append((made["px"][place], made["py"][place]))
            place = made["after"][place]
        found.append(ring)
        at += len(ring)
    assert found == rings
    assert {0} == {value for name in ("px", "py", "after") for value in made[name][11:]}


@pytest.mark.parametrize(("corner", "fits"), [((0, 23_000), True), ((23_000, 0), True),
                                              ((0, 23_001), False), ((23_001, 0), False),
                                              ((-1, 0), False), ((0, -1), False)])  # fmt: skip
def test_corners_of_a_fence_lie_within_23000_units(corner, fits):
    ring = [corner, (5, 5), (5, 6)]
    if fits:
        assert fence_parameters([ring])["px"][0] == corner[0]
        return
    with pytest.raises(LiveError, match="must be 0 to 23000 units both ways"):
        fence_parameters([ring])


@pytest.mark.parametrize("more", [0, 1])
def test_a_fence_has_so_many_corners_at_most(more):
    ring = [(k, k * k) for k in range(POINTS + more)]
    if not more:
        assert fence_parameters([ring])["points"] == POINTS
        return
    with pytest.raises(LiveError, match=f"here: the fence has {POINTS + 1} corners, more than"):
        fence_parameters([ring], "here")


NO_AREA = [
    ([(5, 5)] * 3, "must have 3 corners or more, not 2"),
    ([(5, 5)] * 4, "has corner 0 twice in a row"),
    ([(5, 5), (9, 5), (5, 5)], "must have 3 corners or more, not 2"),
    ([(5, 5), (9, 5), (9, 5), (5, 5)], "has corner 1 twice in a row"),
    ([(5, 5), (9, 9), (7, 7)], "touches itself: edges 0 and 1 lie on each other"),
    ([(0, 0), (9, 0), (9, 9), (9, 5), (9, 0)], "touches itself: edge 0"),
    ([(0, 0), (9, 9), (9, 0), (0, 9)], "crosses itself: edge 0"),
]


@pytest.mark.parametrize("is_hole", [False, True])
@pytest.mark.parametrize(("ring", "words"), NO_AREA)
def test_rings_without_an_area_are_refused_in_the_same_words_here_and_there(ring, words, is_hole):
    name = "fence.holes.0" if is_hole else "fence.polygon"
    rings = [square(-1, 20), ring] if is_hole else [ring]
    rings = [[(x + 1, y + 1) for x, y in one] for one in rings]
    with pytest.raises(LiveError, match=rf"^n3\.toml: {name} {words}"):
        fence_parameters(rings, "n3.toml")
    fence = {"polygon": rings[0], "holes": rings[1:]}
    with pytest.raises(scenario.ScenarioError, match=f"{name} {words}"):
        simulated(fence=fence)


def test_holes_lie_inside_and_apart_and_a_ring_may_be_closed():
    outer, hole, other = square(0, 900), square(100, 200), square(150, 250)
    closed = [*outer, outer[0]]
    assert fence_parameters([closed, hole]) == fence_parameters([outer, hole])
    with pytest.raises(LiveError, match=r"fence\.holes\.0 is not wholly inside fence\.polygon"):
        fence_parameters([hole, outer])
    with pytest.raises(LiveError, match=r"fence\.holes\.0 and 1 overlap or touch"):
        fence_parameters([outer, hole, other])
