"""Every medium calls a protocol's functions with what is the node's, in their order."""

from types import SimpleNamespace as Of

import pytest

from innervate.networks.mesh.sim import stacks
from innervate.sim.cables import declared as cables
from innervate.sim.channel import declared as channel
from innervate.sim.field import access, listening
from innervate.sim.field import declared as field
from innervate.sim.handlers import access_handlers, handlers

NODE, NOW, FRAME = 1, 500, "a frame"
CALLED = {  # what each is called with, behind the world and the node
    "on_start": (NOW, 3), "on_frame": (NOW, FRAME), "on_timer": (NOW, 4), "on_input": (NOW, 5),
    "on_carrier": (NOW, 6, 7),
}  # fmt: skip
HANDED = {  # what is handed on, between the parameters and the outbox
    "on_start": (NOW, 3), "on_frame": (NOW, 0, FRAME), "on_timer": (NOW, 4),
    "on_input": (NOW, 5, "item"), "on_carrier": (NOW, 6, 7),
}  # fmt: skip


class Protocol:
    """Notes what it is called with."""

    def __init__(self, *without):
        self.said = []
        for name in HANDED:
            if name not in without:
                setattr(self, name, lambda *what, name=name: self.said.append((name, *what)))

    def look(self, world, node):
        """Frames are looked at once a handler is done."""
        self.said.append(("look", world is WORLD or world.cells[0], node))


WORLD = Of(
    stations=["s0", "s1"], nodes=["n0", "n1"], params=["params"], out="out", item=["item"],
    macs=["m0", "m1"], mac_params=["mac params"], mac_out="mac out", mac_item=["item"],
    gates=["g0", "g1", "g2"], radios=[Of(gate=0), Of(gate=2)],
)  # fmt: skip


@pytest.mark.parametrize("name", HANDED)
def test_over_a_channel(name):
    protocol = Protocol()
    handlers(protocol)[name](WORLD, NODE, *CALLED[name])
    assert protocol.said == [(name, "s1", "params", *HANDED[name], "out")]


@pytest.mark.parametrize("name", ["on_start", "on_frame", "on_timer", "on_carrier"])
def test_over_a_channel_frames_of_a_declared_protocol_are_looked_at(name):
    protocol = Protocol()
    made = channel._entries(protocol, protocol.look, copy_frame=None, stamp=None)
    made[name](WORLD, NODE, *CALLED[name])
    assert protocol.said == [(name, "s1", "params", *HANDED[name], "out"), ("look", True, NODE)]


@pytest.mark.parametrize("name", HANDED)
def test_over_a_field(name):
    protocol = Protocol()
    made = field._entries(protocol, set(), protocol.look)
    made[name](WORLD, NODE, *CALLED[name])
    assert protocol.said == [(name, "s1", "params", *HANDED[name], "out"), ("look", True, NODE)]


@pytest.mark.parametrize("name", ["on_start", "on_timer", "on_frame", "on_input"])
def test_over_cables(name):
    protocol = Protocol()
    world = Of(cells=["c0", "c1"], params=["params"], out="out", sample=["item"],
               clocks=[None, Of(offset=100, rate=0)])  # fmt: skip
    called = {**CALLED, "on_frame": (NOW - 100, 2, FRAME)}
    handed = {**HANDED, "on_frame": (NOW, 2, FRAME)}
    cables._entries(protocol, protocol.look)[name](world, NODE, *called[name])
    assert protocol.said == [(name, "c1", "params", *handed[name], "out"), ("look", "c0", NODE)]


@pytest.mark.parametrize("name", ["on_start", "on_timer", "on_frame", "on_input"])
def test_a_router_has_a_gateways_record_besides(name):
    protocol = Protocol()
    handlers(protocol, stacks.ROUTER)[name](WORLD, NODE, *CALLED[name])
    assert protocol.said == [(name, "n1", "g2", "params", *HANDED[name], "out")]


@pytest.mark.parametrize("name", HANDED)
def test_a_medium_access_has_records_of_its_own(name):
    protocol = Protocol()
    access_handlers(protocol)[f"mac_{name}"](WORLD, NODE, *CALLED[name])
    assert protocol.said == [(name, "m1", "mac params", *HANDED[name], "mac out")]


@pytest.mark.parametrize("name", HANDED)
def test_without_a_medium_access_nothing_is_called(name):
    assert access_handlers(None)[f"mac_{name}"](WORLD, NODE, *CALLED[name]) is None


@pytest.mark.parametrize("name", HANDED)
def test_what_a_protocol_has_not_is_not_made(name):
    assert set(HANDED) - set(handlers(Protocol(name))) == {name}


def test_who_hears_carriers_is_told_of_its_own_end_and_of_changes(monkeypatch):
    told = []
    monkeypatch.setattr(
        listening, "tell_carrier", lambda _w, _do, *what: told.append(("one", *what))
    )
    monkeypatch.setattr(
        listening, "tell_changes", lambda _w, _do, *what: told.append(("all", *what))
    )
    made = field._entries(Protocol(), set(), print)
    made["tell_end"](WORLD, None, NODE, NOW, 1)
    made["note_carriers"](WORLD, None, NOW)
    assert told == [("one", NODE, NOW), ("all", NOW)]
    deaf = field._entries(Protocol("on_carrier"), set(), print)
    deaf["tell_end"](WORLD, None, NODE, NOW, 1)
    deaf["note_carriers"](WORLD, None, NOW)
    assert len(told) == 2


def test_who_wants_to_know_is_told_what_became_of_its_frames(monkeypatch):
    told = []
    monkeypatch.setattr(listening, "tell_gone", lambda _w, _do, *what: told.append(what))
    protocol = Protocol("on_carrier")
    protocol.on_sent = lambda *what: protocol.said.append(what)
    made = field._entries(protocol, set(), protocol.look)
    made["on_sent"](WORLD, NODE, NOW, 1)
    made["tell_end"](WORLD, None, NODE, NOW, 0)
    made["note_carriers"](WORLD, None, NOW)
    assert protocol.said == [("s1", "params", NOW, 1, "out"), ("look", True, NODE)]
    assert told == [(NODE, NOW, 0)]


def test_frames_pass_through_a_function_on_their_way():
    do = stacks.plain(stacks.mesh(), stacks.Layer(access), None)
    assert do.copy_frame is stacks.copy_frame
    seen = []
    through = stacks.plain(stacks.mesh(), stacks.Layer(access, "channel"), seen.append)
    with pytest.raises(AttributeError):
        through.copy_frame(Of(), "frame")
    assert (seen, through.channel, do.channel) == (["frame"], "channel", None)
    assert do.short is access.short
