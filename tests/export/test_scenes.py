"""Primitives of a recorded scene, as Foxglove's schemas have them: metres, quaternions, 0 to 1."""

import pytest

from innervate.export import scenes

STILL = {"x": 0, "y": 0, "z": 0, "w": 1}  # a quaternion that turns nothing


def pose(x, y, z):
    return {"position": {"x": x, "y": y, "z": z}, "orientation": STILL}


@pytest.mark.parametrize(("time_us", "sec", "nsec"), [
    (0, 0, 0), (1, 0, 1000), (999_999, 0, 999_999_000), (1_000_000, 1, 0), (61_000_002, 61, 2000),
])  # fmt: skip
def test_a_time_is_whole_seconds_and_nanoseconds(time_us, sec, nsec):
    assert scenes.stamp(time_us) == {"sec": sec, "nsec": nsec}


def test_a_ball_is_opaque_as_wide_each_way_and_where_it_is():
    assert scenes.ball((1, 2.00004, 3.00006), 0.5, (0.1, 0.23456, 1)) == {
        "pose": pose(1, 2.0, 3.0001), "size": {"x": 0.5, "y": 0.5, "z": 0.5},
        "color": {"r": 0.1, "g": 0.235, "b": 1, "a": 1},
    }  # fmt: skip


def test_words_stand_a_metre_and_a_half_above_their_place_and_face_who_looks():
    made = scenes.text((1, 2, 3), "n1")
    assert (made["pose"], made["text"]) == (pose(1, 2, 4.5), "n1")
    assert (made["billboard"], made["scale_invariant"], made["color"]["a"]) == (True, True, 1)


@pytest.mark.parametrize(("kind", "number"), [
    (scenes.LINE_STRIP, 0), (scenes.LINE_LOOP, 1), (scenes.LINE_PAIRS, 2),
])  # fmt: skip
def test_lines_go_through_their_points_by_the_numbers_of_foxglove(kind, number):
    made = scenes.lines(kind, 0.1, scenes.GREY, [(0, 0, 0), (1, 2, 3)])
    assert (made["type"], made["thickness"], made["pose"]) == (number, 0.1, pose(0, 0, 0))
    assert made["points"] == [{"x": 0, "y": 0, "z": 0}, {"x": 1, "y": 2, "z": 3}]
    assert (made["colors"], made["indices"], made["scale_invariant"]) == ([], [], False)


def test_an_entity_stays_until_it_is_replaced_and_has_every_kind_of_primitive():
    ball = scenes.ball((0, 0, 0), 1, scenes.BLUE)
    made = scenes.entity(1_500_000, "n1", spheres=[ball])
    assert (made["id"], made["frame_id"], made["frame_locked"]) == ("n1", "world", False)
    assert (made["timestamp"], made["lifetime"]) == (
        {"sec": 1, "nsec": 500_000_000}, {"sec": 0, "nsec": 0})  # fmt: skip
    others = {"arrows", "cubes", "cylinders", "lines", "triangles", "texts", "models"}
    assert made["spheres"] == [ball]
    assert all(made[kind] == [] for kind in others)
