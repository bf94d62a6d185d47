"""What an explored call puts into its outbox: fields of frames, and how many frames there are."""

from types import SimpleNamespace

import pytest

from innervate.dialect.outbox import DELIVER, SEND, SET_TIMER
from innervate.verify.frames import Frames
from innervate.verify.states import Node, State, most_frames

FIELDS = (
    ("kind", 0, 0, 3, "", ""),
    ("value", 0, 2, 9, "", ""),
    ("aside", 0, 1, 9, "", ""),
    ("row", 2, 0, 5, "", ""),
)
NAMED = Frames(FIELDS, [(1, "one", [("value", 4), ("row", 3)])])


def frame(**given):
    return SimpleNamespace(**{"kind": 1, "value": 4, "aside": 3, "row": [1, 2]} | given)


@pytest.mark.parametrize(
    ("given", "action", "words"),
    [
        ({}, SEND, ""),
        ({"value": None}, SEND, "value of a frame that tell sends is not set"),
        ({"value": 1}, SEND, "value of a frame that tell sends is 1, declared 2 to 9"),
        ({"value": 10}, DELIVER, "value of a frame that tell delivers is 10, declared 2 to 9"),
        ({"value": 10}, SET_TIMER, ""),
        ({"row": [5, 6]}, SEND, "row of a frame that tell sends is 6, declared 0 to 5"),
        ({"aside": None}, SEND, ""),
        ({"kind": 2}, SEND, "tell sends a frame of kind 2, which has no layout"),
    ],
)
def test_what_is_wrong_with_a_frame_is_said(given, action, words):
    assert NAMED.wrong(frame(**given), action, "tell") == words


def test_what_a_layout_has_no_bits_for_is_not_sent_but_delivered():
    sent, delivered = frame(), frame()
    NAMED.wrong(sent, SEND, "tell")
    NAMED.wrong(delivered, DELIVER, "tell")
    assert vars(sent) == {"kind": 1, "value": 4, "aside": 0, "row": [1, 2]}
    assert vars(delivered) == vars(frame())


def test_frames_are_counted_where_most_are():
    late = ((5, 0, ()), (6, 1, ()), (7, 1, ()))
    nodes = [Node((), ()), Node((), (), down=((),)), Node((), (), late=late)]
    assert [most_frames(State((node,), ((),), ())) for node in nodes] == [0, 1, 2]
    assert most_frames(State((Node((), (), airing=3),), ((), ((),)), ())) == 3
