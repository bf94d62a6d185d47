"""Everything that stops a run as broken: each is broken alone, and is told by its own words.

A network under way, plain and in order, is tampered with at one moment; the checker has to speak,
also where the run ends right behind what broke it. The same network left alone goes on.
"""

from itertools import count
from types import SimpleNamespace

import pytest

from innervate.dialect.outbox import report, send
from innervate.networks.mesh.sim import recorder as mesh_recorder
from innervate.networks.mesh.sim import simulate as mesh
from innervate.networks.radio.protocol.fields import FRAME
from innervate.networks.radio.sim import recorder as radio_recorder
from innervate.networks.radio.sim import simulate as radio
from innervate.networks.skin.protocol.constants import REPORT_BALANCE, TICK
from innervate.networks.skin.sim import observer as skin_observer
from innervate.networks.skin.sim import simulate as skin
from innervate.networks.skin.sim import stack as skin_stack
from innervate.sim.cables import calls
from innervate.sim.cables import world as cables
from innervate.sim.channel import loop as channel_loop
from innervate.sim.channel import medium as channel_medium
from innervate.sim.driver import InvariantBroken
from innervate.sim.field import medium as field_medium
from innervate.sim.status import DONE, ON_TIMER
from tests.networks.mesh import pinger
from tests.networks.mesh.channel_runs import team
from tests.networks.mesh.runs import mesh_plan
from tests.networks.radio.runs import radio_plan
from tests.networks.skin.runs import line, plan_of

ALL = 255
FOR_EVER = 1 << 30


def go(running, until_us):
    """Run on up to a time."""
    while running.advance(until_us, FOR_EVER) != DONE:
        pass


# A skin: n1's parent is n0, n0's is the PC, everything has settled.


def skin_at(tampered_us, **kept):
    running = skin.simulation(plan_of(line(3, duration_s=0.5)), plain=True, **kept)
    go(running, tampered_us)
    return running


def parent_is(running, cell, port):
    """A cell reports, at a tick, that it has taken a parent."""
    world = running.world
    report(world.out, REPORT_BALANCE, 0, port)
    calls.finish(world, skin_stack, cell, running.clock_us(), ON_TIMER, TICK)


def child_as_parent(running):
    """Cell 0 takes the cell for its parent whose parent it is."""
    graph = running.plan.graph
    (port,) = (p for p in range(4) if graph.peer[p] >= 0 and graph.node_of(graph.peer[p]) == 1)
    parent_is(running, 0, port)


def fd_like_the_parents(running):
    mine, above = running.world.cells[1], running.world.cells[0]
    mine.fd_known, mine.fd_sq, mine.fd_dist = above.fd_known, above.fd_sq, above.fd_dist
    parent_is(running, 1, mine.parent)


def same_parent_again(running):
    parent_is(running, 1, running.world.cells[1].parent)


def cell_out_of_range(running):
    running.world.cells[1].last_command = 65536


def pc_out_of_range(running):
    running.world.pc.own[0].repair = 2


def outbox_of_one(running):
    running.world.out.limit[0] = 1


def out_of_no_port(running):
    """Cell 1 sends; its ports are 0 to 3, and what stands behind them is its neighbour's."""
    world = running.world
    send(world.out, 4, 0, 0)
    calls.finish(world, skin_stack, 1, running.clock_us(), ON_TIMER, TICK)


# A team of three stations that have a packet each, and one of them the channel.


def radio_at(tampered_us):
    plan = radio_plan(3, traffic="saturated", packets=40, duration_s=0.5)
    running = radio.simulation(plan, plain=True)
    go(running, tampered_us)
    return running


def radios_deaf(running):
    for one in running.world.radios:
        one.deaf = channel_medium.SENDING


def still_on_the_air(running):
    for air in running.world.air:
        air.end = FOR_EVER


def frames_of_no_slots(running):
    frames = running.world.out.frame

    class Empty(type(frames[0])):
        slots = property(lambda _: 0, lambda *_: None)

    frames[:] = [Empty() for _ in frames]


def a_turn_that_lasts(running):
    running.world.run[0].data_until = FOR_EVER


def station_out_of_range(running):
    running.world.stations[1].lonely = 32


def frames_that_change(running):
    """Whatever is on the air says something else each time that it is looked at."""
    frames, numbers = running.world.frames, count()

    class Restless(type(frames[0])):
        handle = property(lambda _: next(numbers) & 0xFFFF, lambda *_: None)

    for place, frame in enumerate(frames):
        frames[place] = made = Restless()
        for name, *_ in FRAME:
            if name != "handle":
                setattr(made, name, getattr(frame, name))


# A mesh of five nodes of which one after the other says something to all.


def mesh_plan_of(make, n=5):
    return make(n, offers=[(1_000 + 9_000 * k, k % n, ALL, 9) for k in range(40)], duration_s=0.5)


def mesh_at(tampered_us, make=mesh_plan):
    running = mesh.simulation(mesh_plan_of(make), plain=True, entry=pinger)
    go(running, tampered_us)
    return running


def mesh_over_channel_at(tampered_us):
    return mesh_at(tampered_us, team)


def no_room_on_the_air(running):
    running.world.run[0].free = 0


def router_out_of_range(running):
    running.world.nodes[1].rssi[2] = 600


def gateway_out_of_range(running):
    running.world.gates[0].job_count[4] = 16


def delivered_before(running):
    """Node 2 has had the next packets of everybody already."""
    world = running.world
    for origin in range(5):
        for ahead in range(4):
            frame = SimpleNamespace(origin=origin, seq=(world.nodes[origin].seq + ahead) & 65535)
            mesh_recorder.check_once(world, 2, frame, running.clock_us())


def frame_under_way(running):
    for one in running.world.radios:
        one.held = 3


def frames_changed(running):
    """What is on the air is no longer what was sent."""
    for air in running.world.air:
        air.digest ^= 1


def channel_outbox_of_one(running):
    running.world.below.out.limit[0] = 1


SKIN, RADIO, MESH = "skin", "radio", "mesh"
AT = {SKIN: (skin_at, 300_000), RADIO: (radio_at, 150_000), MESH: (mesh_at, 50_000)}
OVER = "mesh over a channel"
AT[OVER] = (mesh_over_channel_at, 50_000)

# Of every network: what is broken, what breaks it, the words, and whom they name.
CASES = [
    (SKIN, skin_observer.BROKEN_LOOP, child_as_parent, "forwarding loop through p0 r0 c0"),
    (SKIN, skin_observer.BROKEN_FEASIBLE, fd_like_the_parents,
     "feasible distance of p0 r0 c1 is not worse than that of its parent p0 r0 c0"),
    (SKIN, cables.BROKEN_RANGE, cell_out_of_range,
     "a value of p0 r0 c1 is out of its declared range"),
    (SKIN, cables.BROKEN_RANGE, pc_out_of_range, "a value of pc is out of its declared range"),
    (SKIN, cables.BROKEN_OUTBOX, outbox_of_one, "outbox of "),
    (SKIN, cables.BROKEN_PORT, out_of_no_port, "p0 r0 c1 sends out of a port that no node has"),
    (RADIO, channel_medium.BROKEN_DEAF, radios_deaf, "sent while its radio could not"),
    (RADIO, channel_medium.BROKEN_AIR, still_on_the_air, "has too many transmissions under way"),
    (RADIO, channel_medium.BROKEN_EMPTY, frames_of_no_slots, "sent a frame of no slots"),
    (RADIO, channel_loop.BROKEN_OUTBOX, outbox_of_one, "outbox of station "),
    (RADIO, channel_loop.BROKEN_FRAME, frames_that_change,
     "a receiver changed the frame that station "),
    (RADIO, radio_recorder.BROKEN_TURNS, a_turn_that_lasts,
     "began a turn while another station had its own"),
    (RADIO, channel_medium.BROKEN_RANGE, station_out_of_range,
     "a value of station 1 is out of its declared range"),
    (MESH, field_medium.BROKEN_AIR, no_room_on_the_air, "has too many frames under way"),
    (MESH, field_medium.BROKEN_OUTBOX, outbox_of_one, "outbox of node n"),
    (MESH, field_medium.BROKEN_RANGE, router_out_of_range,
     "a value of node n1 is out of its declared range"),
    (MESH, field_medium.BROKEN_RANGE, gateway_out_of_range,
     "a value of node n0 is out of its declared range"),
    (MESH, mesh_recorder.BROKEN_TWICE, delivered_before, "node n2 delivered a packet twice"),
    (MESH, field_medium.BROKEN_HELD, frame_under_way,
     "handed down a frame while another was under way"),
    (MESH, field_medium.BROKEN_FRAME, frames_changed, "a receiver changed the frame that node n"),
    (OVER, mesh_recorder.BROKEN_BELOW, channel_outbox_of_one, "outbox of station "),
]  # fmt: skip


def begun(network):
    make, at = AT[network]
    return make(at)


def broken_by(network, tamper, until):
    """What a network says that is tampered with and runs on, and when it broke, us; "" nothing."""
    running = begun(network)
    tamper(running)
    try:
        go(running, until)
    except InvariantBroken as error:
        return str(error)
    return ""


@pytest.mark.parametrize(
    ("network", "code", "tamper", "words"), CASES, ids=[f"{c[0]}: {c[2].__name__}" for c in CASES]
)
def test_what_is_broken_is_told_by_name(network, code, tamper, words):
    said = broken_by(network, tamper, 500_000)
    assert said.startswith("invariant broken at 0.")
    assert words in said.partition("(seed 1): ")[2]
    at_us = round(1e6 * float(said.split()[3]))
    assert AT[network][1] - 10_000 <= at_us < 500_000
    assert broken_by(network, tamper, at_us + 1) == said  # nothing comes behind it


@pytest.mark.parametrize("network", AT)
def test_what_is_left_alone_goes_on(network):
    running = begun(network)
    before = running.fingerprint
    go(running, 500_000)
    assert running.fingerprint != before


def test_a_route_told_again_breaks_nothing():
    assert broken_by(SKIN, same_parent_again, 500_000) == ""


@pytest.mark.parametrize(
    "tamper", [child_as_parent, fd_like_the_parents, cell_out_of_range, pc_out_of_range]
)
def test_without_checks_nothing_is_said(tamper):
    running = skin_at(300_000, checks=False)
    tamper(running)
    go(running, 310_000)
    assert running.clock_us() > 309_000


def codes(*modules):
    """All that can be broken, as some modules name it."""
    return {value for module in modules for name, value in vars(module).items()
            if name.startswith("BROKEN_") and isinstance(value, int)}  # fmt: skip


def test_everything_that_can_be_broken_has_a_case():
    tried = {network: {code for of, code, *_ in CASES if of == network} for network in AT}
    assert tried[SKIN] == codes(skin_observer, cables) == set(skin.SkinSimulation.broken_words)
    assert tried[RADIO] == set(radio.RadioSimulation.broken_words)
    assert tried[RADIO] == codes(channel_medium, channel_loop, radio_recorder)
    assert tried[MESH] == set(mesh.MeshSimulation.broken_words)
    assert tried[MESH] | tried[OVER] == codes(field_medium, mesh_recorder)


@pytest.mark.parametrize(
    ("words", "modules"),
    [
        (mesh.MeshSimulation.broken_words, [mesh_recorder, field_medium]),
        (radio.RadioSimulation.broken_words, [radio_recorder, channel_loop, channel_medium]),
    ],
)
def test_whatever_can_be_broken_has_a_number_and_words_of_its_own(words, modules):
    codes = {
        (name, value)
        for module in modules
        for name, value in vars(module).items()
        if name.startswith("BROKEN_") and name != "BROKEN_BELOW"
    }
    assert len({value for _, value in codes}) == len(codes)
    assert {value for _, value in codes} == set(words)
