"""What a call puts into its outbox is looked at: values in their ranges, kinds with layouts."""

from types import SimpleNamespace as Of

import pytest

from innervate.dialect.outbox import DELIVER, REPORT, SEND, SET_TIMER
from innervate.network import layouts_of
from innervate.sim.sent import FRAME_BROKEN, KIND_BROKEN, look_of

FRAME = (("kind", 0, 0, 9, "", ""), ("lap", 0, -3, 300, "", ""), ("path", 2, 1, 9, "", ""),
         ("rssi", 0, -99, 0, "", ""))  # fmt: skip

LAYOUTS = ((1, "ping", (("lap", 0, 9, 1), ("path", 2, 4, 0))), (4, "lap", (("lap", 0, 9, 1),)))


def frame(**more):
    return Of(**{"kind": 1, "lap": 0, "path": [1, 9], "rssi": 50} | more)


def looked(*acts, count=None, **run):
    """What is broken, and where, once node 5 has put this out."""
    made = Of(**{"checks": 1, "broken": 0, "broken_node": -1} | run)
    actions, frames = [Of(kind=what) for what, _ in acts], [one for _, one in acts]
    out = Of(count=[len(acts) if count is None else count], action=actions, frame=frames)
    look_of(FRAME, LAYOUTS)(Of(run=[made], out=out), 5)
    return made.broken, made.broken_node


@pytest.mark.parametrize(("what", "given", "found"), [
    (SEND, {}, 0), (SEND, {"lap": 300, "path": [9, 1]}, 0), (SEND, {"lap": -3, "kind": 4}, 0),
    (SEND, {"lap": 301}, FRAME_BROKEN), (SEND, {"lap": -4}, FRAME_BROKEN),
    (SEND, {"path": [1, 10]}, FRAME_BROKEN), (DELIVER, {"path": [0, 1]}, FRAME_BROKEN),
    (SEND, {"kind": 2}, KIND_BROKEN), (DELIVER, {"kind": 2}, 0),
    (SEND, {"kind": 10}, FRAME_BROKEN), (REPORT, {"lap": 999}, 0), (SET_TIMER, {"lap": 999}, 0),
])  # fmt: skip
def test_what_is_sent_or_delivered_lies_in_its_range_and_what_is_sent_has_a_layout(
    what, given, found
):
    assert looked((SEND, frame()), (what, frame(**given))) == (found, 5 if found else -1)


def test_only_what_the_call_put_out_is_looked_at_and_what_broke_first_stays():
    assert looked((SEND, frame()), (SEND, frame(lap=999)), count=1) == (0, -1)
    assert looked((SEND, frame(lap=999)), checks=0) == (0, -1)
    assert looked((SEND, frame(lap=999)), broken=2, broken_node=7) == (2, 7)


@pytest.mark.parametrize(("kind", "path", "lap"), [(1, [7, 9], 5), (4, [0, 0], 5), (5, [0, 0], 0)])
@pytest.mark.parametrize("checks", [0, 1])
def test_what_a_layout_has_no_bits_for_is_not_sent(kind, path, lap, checks):
    sent, kept = frame(path=[7, 9], lap=5, kind=kind), frame(path=[7, 9], lap=5, kind=kind)
    out = Of(count=[2], action=[Of(kind=SEND), Of(kind=DELIVER)], frame=[sent, kept])
    world = Of(run=[Of(checks=checks, broken=0, broken_node=-1)], out=out)
    look_of(FRAME, (*LAYOUTS, (5, "none", ())))(world, 5)
    assert (sent.path, sent.lap, sent.rssi) == (path, lap, 50)
    assert (kept.path, kept.lap) == ([7, 9], 5)


def test_layouts_say_which_kinds_there_are_unless_packets_go_over_the_wire():
    layouts = Of(LAYOUTS=LAYOUTS)
    for parts, found in ((["frames"], LAYOUTS), (["frames", "packets"], ()), ([], ())):
        assert layouts_of(Of(has=parts.__contains__, frames=layouts)) == found
    assert layouts_of(Of(has=["frames"].__contains__, frames=Of())) == ()
