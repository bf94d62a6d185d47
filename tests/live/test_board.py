"""What of a network runs on a board, if it says nothing of that itself."""

from types import SimpleNamespace as Of

import pytest

from innervate.live import board
from innervate.network import networks

FRAME = (("kind", 0, 1, 3, "", "of a frame"),)
LAYOUTS = ((1, "hello", (("who", 0, 8, 0),)),)


def network(medium, without=(), **frames):
    parts = {
        "protocol": Of(__name__="gossip.protocol"), "frames": Of(LAYOUTS=LAYOUTS, **frames),
        "fields": Of(STATE=FRAME, PARAMS=FRAME, FRAME=FRAME),
    }  # fmt: skip
    parts = {name: part for name, part in parts.items() if name not in without}
    return Of(name="gossip", medium=medium, has=lambda part: part in parts, **parts)


@pytest.mark.parametrize("medium", ["cables", "channel", "field"])
def test_a_plain_protocol_does_and_over_cables_by_the_program_for_small_boards(medium):
    (role,) = board.roles_of(network(medium))
    assert (role.name, role.kinds) == ("gossip", {1: board.on_wire(LAYOUTS[0][2])})
    assert role.program is (board.PLAIN if medium == "cables" else None)
    assert role.watched.table == ("cells" if medium == "cables" else "stations")


@pytest.mark.parametrize("part", ["protocol", "fields", "frames"])
def test_without_one_of_its_parts_nothing_does(part):
    assert board.roles_of(network("cables", without=[part])) == ()


def test_frames_that_are_coded_by_hand_do_not():
    assert board.roles_of(network("cables", encode=bytes)) == ()


def test_what_a_network_says_itself_counts():
    mesh = networks()["mesh"]
    assert board.roles_of(mesh) is mesh.boards
