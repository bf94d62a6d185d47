"""What of a network of one's own runs on a board."""

from types import SimpleNamespace as Of

import pytest

from innervate.live.board import FIELD, PLAIN, roles_of

STATE, PARAMS, FRAME = ((name, 0, 0, 9, "", "") for name in ("seen", "hops", "kind"))
LAYOUTS = ((1, "hello", (("seq", 0, 8, 0), ("", 0, 4, 0), ("list", 3, 4, 1))),)


def network_of(medium="cables", lacks="", **more):
    parts = {
        "protocol": Of(__name__="talk.protocol", OUTBOX=5, TIMERS=2),
        "fields": Of(STATE=(STATE,), PARAMS=(PARAMS,), FRAME=(FRAME,)),
        "frames": Of(LAYOUTS=LAYOUTS),
    } | more  # fmt: skip
    parts.pop(lacks, None)
    return Of(name="talk", medium=medium, has=parts.__contains__, **parts)


@pytest.mark.parametrize(("medium", "program", "table"), [
    ("cables", PLAIN, "cells"), ("channel", None, "stations"), ("field", FIELD, "stations"),
])  # fmt: skip
def test_a_plain_protocol_is_one_role_and_but_on_a_channel_a_program(medium, program, table):
    (role,) = roles_of(network_of(medium))
    assert (role.name, role.entry, role.room, role.timers) == ("talk", "talk.protocol", 5, 2)
    assert (role.state, role.params, role.frame, role.item) == (
        (STATE,), (PARAMS,), (FRAME,), (FRAME,),
    )  # fmt: skip
    assert role.kinds == {1: (("seq", 0), ("list", 3))}
    assert (role.program, role.watched.table) == (program, table)


def test_what_says_its_own_roles_or_has_a_coder_of_its_own_is_not_plain():
    assert roles_of(network_of(boards=("mine",))) == ("mine",)
    assert roles_of(network_of(frames=Of(LAYOUTS=LAYOUTS, encode=print))) == ()
    for part in ("protocol", "fields", "frames"):
        assert roles_of(network_of(lacks=part)) == ()
