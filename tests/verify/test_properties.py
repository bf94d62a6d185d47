"""Every property that the explorers look at: broken alone and told by its title, else silent."""

import ast
import inspect
from types import SimpleNamespace
from unittest.mock import patch

import numpy as np
import pytest

from innervate.dialect.outbox import deliver, report, send
from innervate.networks.mesh.protocol import constants as mesh_const
from innervate.networks.mesh.protocol import node as mesh_node
from innervate.networks.mesh.protocol.frames import copy_frame
from innervate.networks.mesh.verify import fair as mesh_fair
from innervate.networks.mesh.verify import first, local, net
from innervate.networks.mesh.verify import model as mesh_model
from innervate.networks.mesh.verify import search as mesh_search
from innervate.networks.mesh.verify import story as mesh_story
from innervate.networks.radio.protocol.constants import CRR, DATA, WINDOWS
from innervate.networks.radio.sim import simulate as radio
from innervate.networks.radio.verify import grid
from innervate.networks.skin.verify import check as skin_check
from innervate.networks.skin.verify import graphs, moves, row
from innervate.networks.skin.verify import story as skin_story
from innervate.networks.skin.verify import system as skin_system
from innervate.networks.skin.verify import world as w
from innervate.sim import status
from innervate.sim.channel import world as channel_world
from innervate.sim.tables import row_dtype
from innervate.verify import declared
from innervate.verify.graphs import graph_of
from innervate.verify.twin import Twin
from tests.networks.radio.runs import radio_plan
from tests.verify.test_air import FIELDS

# The skin: cells 1 and 2 of "pair" have each other and the PC for neighbours.


def skin_world(rule="feasible"):
    return Twin(skin_system.SkinModel(graphs.parse("pair"), rule), skin_system.system_of()).world


def routed(world, fds, parents):
    """Cells with feasible distances (number, hops), None none, and the nodes they go by."""
    for c, (fd, above) in enumerate(zip(fds, parents, strict=True)):
        row.load_cell(world, c, 0)
        cell = world.cells[0]
        cell.fd_known = int(fd is not None)
        cell.fd_sq, cell.fd_dist = fd or (0, 0)
        ways = [world.out_way[4 * c + p] for p in range(4)]
        nodes = [min(world.way_end[way] // 4, 2) if way >= 0 else -1 for way in ways]
        cell.parent = nodes.index(above) if above is not None else -1
        row.save_cell(world, c, 1)
    return skin_check.check(world)


PC = 2
SKIN_CHECKS = [
    # What holds: one by the other, farther; by the PC; a parent that has forgotten; older.
    ("feasible", [(5, 1), (5, 2)], [PC, 0], w.FINE),
    ("feasible", [(5, 1), (4, 1)], [PC, 0], w.FINE),
    ("feasible", [(5, 1), (5, 1)], [PC, PC], w.FINE),
    ("feasible", [None, (5, 1)], [None, 0], w.FINE),
    ("strict", [(5, 1), (5, 1)], [PC, 0], w.FINE),
    # What does not.
    ("feasible", [(5, 1), (5, 1)], [PC, 0], w.BROKEN_ORDER),
    ("feasible", [(5, 2), (5, 1)], [PC, 0], w.BROKEN_ORDER),
    ("feasible", [(4, 1), (5, 9)], [PC, 0], w.BROKEN_ORDER),
    ("feasible", [None, (5, 1)], [PC, 0], w.BROKEN_ORDER),
    ("feasible", [(5, 1), (5, 2)], [1, 0], w.BROKEN_ORDER),
    ("strict", [(5, 1), (5, 2)], [1, 0], w.BROKEN_LOOP),
]


@pytest.mark.parametrize(("rule", "fds", "parents", "code"), SKIN_CHECKS)
def test_what_is_checked_of_routes(rule, fds, parents, code):
    assert routed(skin_world(rule), fds, parents) == code


# Known before, number and hops before; known now, ...; was told; is it broken?
WORSE = [
    ((1, 5, 2), (1, 5, 2), 0, w.FINE), ((1, 5, 2), (1, 5, 1), 0, w.FINE),
    ((1, 5, 2), (1, 6, 9), 0, w.FINE), ((0, 9, 1), (1, 5, 2), 0, w.FINE),
    ((0, 0, 0), (0, 0, 0), 0, w.FINE), ((1, 5, 2), (0, 0, 0), 1, w.FINE),
    ((1, 5, 2), (1, 5, 3), 0, w.BROKEN_WORSE), ((1, 5, 2), (1, 4, 1), 0, w.BROKEN_WORSE),
    ((1, 5, 2), (0, 5, 2), 0, w.BROKEN_WORSE),
]  # fmt: skip


@pytest.mark.parametrize(("before", "after", "forgot", "code"), WORSE)
def test_a_feasible_distance_gets_worse_only_if_it_says_so(before, after, forgot, code):
    world = skin_world()
    world.found[0] = w.FINE
    world.cells[0].fd_known, world.cells[0].fd_sq, world.cells[0].fd_dist = after
    moves.check_feasible(world, *before, forgot)
    assert world.found[0] == code


@pytest.mark.parametrize(("overflow", "code"), [(0, w.FINE), (1, w.BROKEN_OUTBOX)])
def test_an_outbox_of_a_cell_that_overflows(overflow, code):
    world = skin_world()
    world.found[0], world.out.overflow[0] = w.FINE, overflow
    moves.drain(world, 0)
    assert world.found[0] == code


def test_a_cell_out_of_its_range():
    world = skin_world()
    world.found[0], world.cells[0].pf[3] = w.FINE, 1681
    moves.check_range(world)
    assert world.found[0] == w.BROKEN_RANGE
    assert skin_story.TITLES[w.BROKEN_RANGE] == "a value is out of its declared range"


def test_every_property_of_a_skin_has_a_case():
    tried = {code for *_, code in SKIN_CHECKS} | {code for *_, code in WORSE}
    tried |= {w.BROKEN_OUTBOX, w.BROKEN_RANGE}
    assert tried - {w.FINE} == set(skin_story.TITLES)
    assert tried == {w.FINE, *(v for n, v in vars(w).items() if n.startswith("BROKEN_"))}


# The radio: what is said of a run that is over, from its frames and numbers.


def sent_rows(*rows):
    """(kind, start, end, place, next) of frames as a run leaves them."""
    made = np.zeros(len(rows), row_dtype(channel_world.SENT, channel_world.WIDE))
    for at, (kind, start, end, pos, following) in enumerate(rows):
        made[at]["kind"], made[at]["time"], made[at]["end"] = kind, start, end
        made[at]["pos"], made[at]["next"] = pos, following
    return made


FINE_TURNS = ((DATA, 0, 100, 0, 1), (DATA, 150, 250, 1, 1), (DATA, 400, 500, 2, WINDOWS))
PRACTICAL, PAPER = "csma-cd-r/practical", "csma-cd-r/paper"
JUDGED = [
    (PRACTICAL, FINE_TURNS, {}, 0),
    (PRACTICAL, FINE_TURNS, {"status": status.BROKEN}, grid.INVARIANT),
    (PRACTICAL, FINE_TURNS, {"silent": 1}, grid.SILENT),
    (PRACTICAL, FINE_TURNS, {"completed": 2}, grid.DEADLOCK),
    (PRACTICAL, ((DATA, 0, 100, 0, 1), (DATA, 100, 200, 1, 1)), {}, 0),
    (PRACTICAL, ((DATA, 0, 100, 0, 1), (DATA, 99, 200, 1, 1)), {}, grid.OVERLAP),
    (PRACTICAL, ((DATA, 0, 100, 0, 1), (DATA, 150, 200, 2, 2)), {}, grid.ORDER),
    (PRACTICAL, ((DATA, 0, 100, 0, 0), (DATA, 150, 200, 2, 2)), {}, 0),  # its own: a window
    (PRACTICAL, ((DATA, 0, 100, 0, WINDOWS), (DATA, 150, 200, 2, 2)), {}, 0),
    # In the paper's mode only what comes behind the first CR-R, and no places.
    (PAPER, ((DATA, 0, 100, 0, 1), (DATA, 99, 200, 2, 1), (CRR, 300, 308, 0, 0)), {}, 0),
    (PAPER, ((CRR, 0, 8, 0, 0), (DATA, 20, 120, 0, 1), (DATA, 120, 220, 2, 1)), {}, 0),
    (PAPER, ((CRR, 0, 8, 0, 0), (DATA, 20, 120, 0, 1), (DATA, 119, 220, 2, 1)), {}, grid.OVERLAP),
]


@pytest.mark.parametrize(("protocol", "turns", "numbers", "code"), JUDGED)
def test_what_is_judged_of_a_team(protocol, turns, numbers, code):
    run = SimpleNamespace(**{"status": status.DONE, "silent": 0, "completed": 3} | numbers)
    plan = SimpleNamespace(protocol=protocol, wanted=3)
    assert grid.judge(SimpleNamespace(run=[run]), plan, sent_rows(*turns)) == code


def test_a_checker_that_stops_a_teams_run_is_not_taken_for_a_deadlock():
    plan = radio_plan(3, traffic="saturated", packets=5)
    running = radio.simulation(plan, plain=True)
    running.world.out.limit[0] = 1
    running._advance(running.world, plan.duration_us, grid.EVENTS)  # as a search does
    assert grid.judge(running.world, plan, sent_rows()) == grid.INVARIANT


def test_every_property_of_a_team_has_a_case():
    assert {code for *_, code in JUDGED} == {0, *grid.WORDS}


# The mesh: node 2 of a line has a message for node 0; then another node does something wrong.

RELAY, RECIPIENT = 1, 0


def wrong(handler, do, who=RELAY):
    """The router, one of whose nodes does something more in one handler."""
    names = ("on_start", "on_frame", "on_timer", "on_input")
    made = SimpleNamespace(**{name: getattr(mesh_node, name) for name in names}, is_on=False)
    real = getattr(mesh_node, handler)

    def changed(node, gate, params, now, *rest):
        if not made.is_on or node.number != who or do(real, node, gate, params, now, *rest):
            real(node, gate, params, now, *rest)

    setattr(made, handler, changed)
    return made


def twice(real, node, gate, params, now, port, frame, out):
    """The frame goes to the user, as often as it comes."""
    if frame.kind == mesh_const.DATA:
        for _ in range(2):
            copy_frame(out.frame[deliver(out, frame.kind)], frame)
    return True


def out_of_range(real, node, gate, params, now, port, frame, out):
    real(node, gate, params, now, port, frame, out)
    node.rssi[0] = 600


def chatter(real, node, gate, params, now, port, frame, out):
    for _ in range(local.OUTBOX + 1):
        report(out, 1, 0, 0)
    return True


def two_at_once(real, node, gate, params, now, port, frame, out):
    for _ in range(2):
        copy_frame(out.frame[send(out, 0, 0, 0)], frame)


def back_and_forth(real, node, gate, params, now, port, frame, out):
    copy = out.frame[send(out, 0, 0, 0)]
    copy_frame(copy, frame)
    copy.path_len = 4
    for place, hop in enumerate((2, 1, 2, 1)):
        copy.path[place] = hop


def deaf(real, node, gate, params, now, port, frame, out):
    """Nothing is taken in."""


def deaf_to_acks(real, node, gate, params, now, port, frame, out):
    return frame.kind != mesh_const.ACK


def crash(real, node, gate, params, now, port, frame, out):
    return [][1]


MESH_CASES = {
    local.BROKEN_TWICE: twice,
    local.BROKEN_RANGE: out_of_range,
    local.BROKEN_OUTBOX: chatter,
    local.BROKEN_HELD: two_at_once,
    local.BROKEN_ROUND: back_and_forth,
    local.BROKEN_UNHEARD: deaf,
    local.BROKEN_ACKED: deaf_to_acks,
    local.BROKEN_CRASH: crash,
}
BELOW = {local.BROKEN_ENDLESS, local.BROKEN_GATEWAYS, local.BROKEN_DEPOSED, local.BROKEN_FIRST}
CALM = mesh_model.MeshBudget(0, 0, 0, 0)


def explored(entry):
    line = mesh_model.parse("line")
    made = mesh_model.MeshModel(line, settings=mesh_model.SHORT, offers=((2, 0),), budget=CALM)
    nets = net.Nets(made, local.Locals(made, entry))
    begun = first.begin(nets)  # the first round is over, and was in order
    nets.locals.memo.clear()
    entry.is_on = True
    with patch.object(mesh_search, "begin", lambda nets: begun):
        return mesh_search.explore(made, nets=nets, states=2_000)


@pytest.mark.parametrize("code", MESH_CASES, ids=mesh_story.TITLES.get)
def test_what_a_router_does_wrong_is_told_by_name(code):
    found = explored(wrong("on_frame", MESH_CASES[code]))
    assert found.broken == code
    assert mesh_story.TITLES[code] in mesh_story.tell(found).title


def test_a_recipient_is_given_a_message_once():
    def again(real, node, gate, params, now, port, frame, out):
        if frame.kind == mesh_const.DATA:
            copy_frame(out.frame[deliver(out, frame.kind)], frame)
        return True

    found = explored(wrong("on_frame", again, RECIPIENT))
    assert found.broken == local.BROKEN_TWICE


def test_a_router_that_does_nothing_wrong_breaks_nothing():
    found = explored(wrong("on_frame", lambda *_: True))
    assert (found.broken, found.tally.ended) == (0, "complete")


def test_a_calm_future_without_an_end_is_told(monkeypatch):
    assert explored(wrong("on_frame", lambda *_: True)).broken == 0
    monkeypatch.setattr(mesh_fair, "EVENTS_MAX", 2)
    assert explored(wrong("on_frame", lambda *_: True)).broken == local.BROKEN_ENDLESS


def test_nodes_that_follow_two_gateways_are_told():
    def leads(real, node, *more):
        real(node, *more)
        node.gateway = node.number

    made = mesh_model.MeshModel(
        mesh_model.parse("line"), standby=(2,), beats=4, budget=CALM, settings=mesh_model.QUICK
    )
    for do, code in ((lambda *_: True, 0), (leads, local.BROKEN_GATEWAYS)):
        entry = wrong("on_timer", do)
        nets = net.Nets(made, local.Locals(made, entry))
        calm = first.begin(nets).net
        nets.locals.memo.clear()
        entry.is_on = True
        assert mesh_fair.Fair(nets).check(calm) == code


@pytest.mark.parametrize(("leading", "guard_us", "deaths", "lost", "deposed"), [
    ((1, 0, 1), 100, 1, 0, True),
    ((1, 1, 0), 100, 1, 3, True),
    ((1, 0, 1), 100, 1, 4, False),  # four questions in vain: as if it were dead
    ((1, 0, 1), 100, 0, 0, False),  # somebody died
    ((1, 0, 1), 0, 1, 0, False),  # nobody asks
    ((1, 0, 0), 100, 1, 0, False),
])  # fmt: skip
def test_nobody_leads_beside_a_gateway_that_lives(leading, guard_us, deaths, lost, deposed):
    model = SimpleNamespace(budget=mesh_model.MeshBudget(1, 0, 5, 0), beats=1)
    params = SimpleNamespace(guard_us=guard_us)
    states = SimpleNamespace(params=params, field=lambda number, name: leading[number])
    fair = mesh_fair.Fair(SimpleNamespace(model=model, locals=states))
    fair._one_gateway = lambda net: 0
    broken = fair.check(SimpleNamespace(left=(deaths, 0, 5 - lost, 0), nodes=(0, 1, 2)))
    assert broken == (local.BROKEN_DEPOSED if deposed else 0)


def test_every_property_of_a_mesh_has_a_case():
    tried = {*MESH_CASES} | BELOW
    assert tried == set(mesh_story.TITLES)
    assert tried == {v for n, v in vars(local).items() if n.startswith("BROKEN_")}


# Any network that only declares its protocol.


def started(*actions, count=0, timers=2, outbox=4, also=int, slots=None):
    """What is broken as a node starts that asks for these actions."""

    def on_start(node, params, now, cause, out):
        node.count = count
        for kind, a, b, c in actions:
            if out.count[0] >= out.limit[0]:
                out.overflow[0] = 1
                return
            act = out.action[out.count[0]]
            act.kind, act.a, act.b, act.c = kind, a, b, c
            out.count[0] += 1
        also()

    protocol = SimpleNamespace(on_start=on_start, TIMERS=timers, OUTBOX=outbox)
    made = declared.Net(protocol, FIELDS, graph_of("pair"), {})
    if slots is not None:  # of frames on a channel
        made.is_slotted, made.out.frame = True, [SimpleNamespace(kind=0, slots=slots)] * outbox
    return made.begin(declared.Budget())


def fail():
    raise ZeroDivisionError


SEND, TIMER, NOTHING = 1, 2, 9
DECLARED = {
    "an outbox overflowed": ({"actions": [(TIMER, 0, 5, 0)] * 5}, {"actions": [(2, 0, 5, 0)] * 4}),
    " is out of its declared range": ({"count": 4}, {"count": 3}),
    "there is no such timer": ({"actions": [(TIMER, 2, 5, 0)]}, {"actions": [(TIMER, 1, 5, 0)]}),
    "a frame is sent on a port that no node has": (
        {"actions": [(SEND, 4, 0, 0)]}, {"actions": [(SEND, 3, 0, 0)]}),
    "a frame of no slots is sent": (
        {"actions": [(SEND, 0, 0, 0)], "slots": 0}, {"actions": [(SEND, 0, 0, 0)], "slots": 1}),
    "the outbox holds what is no action": (
        {"actions": [(NOTHING, 0, 0, 0)]}, {"actions": [(3, 0, 0, 0), (4, 0, 0, 0)]}),
    "a handler cannot go on: ": ({"also": fail}, {"also": int}),
}  # fmt: skip


@pytest.mark.parametrize("words", DECLARED)
def test_what_any_network_breaks_is_told(words):
    bad, good = map(dict, DECLARED[words])
    assert words in started(*bad.pop("actions", ()), **bad).broken
    assert started(*good.pop("actions", ()), **good).broken == ""


def test_a_handler_that_knows_no_such_name_cannot_go_on():
    broken = started(also=lambda: unheard_of).broken  # noqa: F821
    assert broken.startswith("a handler cannot go on: tests/verify/")


def test_a_timer_below_0_is_none_either():
    assert started((TIMER, -1, 5, 0)).broken == "there is no such timer"
    assert started((SEND, -1, 0, 0)).broken == "a frame is sent on a port that no node has"


def test_every_property_of_any_network_has_a_case():
    tree = ast.parse(inspect.getsource(inspect.getmodule(declared.Net)))
    (made,) = (n for n in tree.body if isinstance(n, ast.ClassDef) and n.name == "Net")
    said = set()
    for function in made.body:
        if isinstance(function, ast.FunctionDef) and function.name in ("call", "broken"):
            skipped = {ast.get_docstring(function), "made_at", "us"}
            found = {n.value for n in ast.walk(function) if isinstance(n, ast.Constant)}
            said |= {text for text in found - skipped if isinstance(text, str)}
    assert said - {""} == set(DECLARED)
