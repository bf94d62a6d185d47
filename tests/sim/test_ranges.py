"""The checkers of ranges: every word of every watched record, at its ends and just beyond them."""

from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

import innervate
from innervate.dialect import plain
from innervate.kernel import records
from innervate.networks.mesh.protocol import fields as mesh_fields
from innervate.networks.mesh.sim import build as mesh_build
from innervate.networks.mesh.sim import simulate as mesh_simulate
from innervate.networks.mesh.verify import shape as mesh_shape
from innervate.networks.radio.protocol import fields as radio_fields
from innervate.networks.radio.sim import build as radio_build
from innervate.networks.radio.sim import recorder as radio_recorder
from innervate.networks.radio.sim.stacks import PROTOCOLS
from innervate.networks.skin.protocol import fields as skin_fields
from innervate.networks.skin.sim import build as skin_build
from innervate.networks.skin.sim import simulate as skin_simulate
from innervate.networks.skin.sim import stack as skin_stack
from innervate.networks.skin.sim import static_stack
from innervate.networks.skin.verify import graphs, moves
from innervate.networks.skin.verify import system as skin_system
from innervate.networks.skin.verify import world as skin_verify
from innervate.sim.cables import recorder as cables_recorder
from innervate.sim.cables.world import BROKEN_RANGE
from innervate.sim.channel import listening
from innervate.sim.field import calls
from innervate.sim.field.medium import BROKEN_RANGE as BROKEN_MESH
from innervate.sim.status import BROKEN, DONE
from innervate.sim.tables import Tables, get, put
from innervate.verify import declared
from innervate.verify.graphs import graph_of
from tests.networks.mesh.runs import mesh_plan
from tests.networks.radio.runs import radio_plan
from tests.networks.skin.runs import line, plan_of

NODE = 1  # whose record is broken; its neighbours' stay as they are
FORMS = {"plain": True, "arrays": False}


class Watched:
    """A record as it is declared, and its checker: `speaks()` if something is out of range."""

    def __init__(self, declaration, record, speaks):
        self.declaration, self.record, self.speaks = declaration, record, speaks

    def put(self, name, place, value):
        """Set a word (place -1: a field that is no array); what it was before."""
        is_array = isinstance(self.record, np.void)
        words = self.record[name] if is_array else getattr(self.record, name)
        if place >= 0:
            before, words[place] = int(words[place]), value
        elif is_array:
            before, self.record[name] = int(words), value
        else:
            before = words
            setattr(self.record, name, value)
        return before


def of_run(world, declaration, table, check, code):
    """A checker of the simulator, which marks the run as broken, and says by whom."""
    run = SimpleNamespace(broken=0, broken_node=-1, checks=1, trail_limit=0, cells=3)
    watched = world._replace(run=[run])

    def speaks():
        run.broken, run.broken_node = 0, -1
        check(watched, NODE)
        assert (run.broken, run.broken_node) in ((0, -1), (code, NODE))
        return run.broken == code

    return Watched(declaration, table[NODE], speaks)


def cells(check, is_plain):
    world = skin_build.build(plan_of(line(3)), is_plain)
    return of_run(world, skin_fields.CELL, world.cells, check, BROKEN_RANGE)


def stations(protocol, is_plain):
    world = radio_build.build(radio_plan(3, protocol=protocol), is_plain, observe=False)

    def check(world, node):
        radio_recorder.watch(world, node, 0, 0, 0)

    fields = radio_fields.STATION + PROTOCOLS[protocol].fields
    return of_run(world, fields, world.stations, check, listening.BROKEN_RANGE)


def routers(is_plain):
    plan = mesh_plan(3, capacity=4)
    world = mesh_build.build(plan, is_plain, observe=False)
    fields = mesh_fields.node(plan.capacity)
    return Watched(fields, world.nodes[NODE], lambda: not calls.is_sound(world, NODE))


def looked_at_between(running, declaration, record, code, node):
    """A record that is looked at whenever the loop comes back."""

    def speaks():
        put(running.world.run, 0, broken=0, broken_node=-1, status=DONE)
        running.mark_broken()
        said = tuple(int(get(running.world.run, 0, name)) for name in ("broken", "broken_node"))
        status = int(get(running.world.run, 0, "status"))
        assert (*said, status) in ((0, -1, DONE), (code, node, BROKEN))
        return said[0] == code

    return Watched(declaration, record, speaks)


def pc(which, is_plain):
    running = skin_simulate.simulation(plan_of(line(3)), plain=is_plain)
    own, of_port = running.sink
    if which == "own":
        return looked_at_between(running, own, running.world.pc.own[0], BROKEN_RANGE, 3)
    ((name, _, *limits),) = of_port
    ports = ((name, len(running.world.pc.size), *limits),)
    return looked_at_between(running, ports, running.world.pc, BROKEN_RANGE, 3)


def gateways(gate, is_plain):
    plan = mesh_plan(3, capacity=4, ranks=[1, -1, 0])
    running = mesh_simulate.simulation(plan, plain=is_plain)
    record, node = running.world.gates[gate], (0, 2)[gate]  # in the order of nodes
    return looked_at_between(running, mesh_fields.gate(4), record, BROKEN_MESH, node)


def channel_nodes(is_plain):
    """Of a network of one's own on a channel: the record of a cell serves as well as any."""
    tables = Tables(is_plain)
    states = tables.states(skin_fields.CELL, NODE + 1)
    low, high = records.bounds(skin_fields.CELL)
    world = SimpleNamespace(
        words=tables.words(states, skin_fields.CELL), low=low, high=high,
        run=[SimpleNamespace(broken=0, broken_node=-1, checks=1)],
    )  # fmt: skip

    def speaks():
        run = world.run[0]
        run.broken, run.broken_node = 0, -1
        listening.check_range(world, NODE)
        assert (run.broken, run.broken_node) in ((0, -1), (listening.BROKEN_RANGE, NODE))
        return run.broken != 0

    return Watched(skin_fields.CELL, states[NODE], speaks)


def explored_cells():
    world = skin_system.SkinModel(graphs.parse("pair")).world(True)

    def speaks():
        world.found[0] = skin_verify.FINE
        moves.check_range(world)
        assert world.found[0] in (skin_verify.FINE, skin_verify.BROKEN_RANGE)
        return world.found[0] == skin_verify.BROKEN_RANGE

    return Watched(skin_fields.CELL, world.cells[0], speaks)


def explored_routers(which):
    fields = (mesh_fields.node, mesh_fields.gate)[which](3)
    # No times: what is kept of these is a distance, and any is in range.
    made, kept = plain.make("Record", fields)(), mesh_shape.Shape(fields, (), 1)

    def speaks():
        try:
            kept.take(made, mesh_shape.NOW)
        except mesh_shape.OutOfRange:
            return True
        return False

    return Watched(fields, made, speaks)


def explored_declared():
    protocol = SimpleNamespace(OUTBOX=4)
    fields = SimpleNamespace(STATE=skin_fields.CELL, FRAME=skin_fields.FRAME, PARAMS=())
    net = declared.Net(protocol, fields, graph_of("pair"), {})

    def speaks():
        said = net.broken(0)
        assert said == "" or said.endswith(" is out of its declared range")
        return said != ""

    return Watched(skin_fields.CELL, net.node, speaks)


# Every checker of ranges by the module it stands in, and what it watches.
WATCHES = {
    "sim.cables.recorder": [
        (f"{name}, {form}", cells, (check, is_plain))
        for form, is_plain in FORMS.items()
        for name, check in (
            ("cells", skin_stack.check),
            ("cells of the static baseline", static_stack.check),
            ("any nodes", cables_recorder.check),
        )
    ],
    "sim.field.calls": [
        (f"routers, {form}", routers, (is_plain,)) for form, is_plain in FORMS.items()
    ],
    "sim.channel.listening": [
        (f"nodes on a channel, {form}", channel_nodes, (is_plain,))
        for form, is_plain in FORMS.items()
    ]
    + [
        (f"{protocol}, {form}", stations, (protocol, is_plain))
        for form, is_plain in FORMS.items()
        for protocol in ("csma-cd-r/practical", "csma-cd-r/paper", "token-ring")
    ],
    "sim.ranges": [
        (f"{name}, {form}", make, (which, is_plain))
        for form, is_plain in FORMS.items()
        for name, make, which in (
            ("the PC", pc, "own"),
            ("the PC's ports", pc, "ports"),
            ("the gateway", gateways, 0),
            ("a standby", gateways, 1),
        )
    ],
    "networks.skin.verify.moves": [("explored cells", explored_cells, ())],
    "networks.mesh.verify.shape": [
        ("explored routers", explored_routers, (0,)),
        ("explored gateways", explored_routers, (1,)),
    ],
    "verify.net": [("explored nodes of any network", explored_declared, ())],
}
ROWS = [row for rows in WATCHES.values() for row in rows]


def words_of(declaration):
    """(name, place or -1, lowest, highest) of every word; of long arrays a few."""
    for name, length, low, high, *_ in declaration:
        places = range(length) if 0 < length <= 8 else (0, length // 2, length - 1)
        for place in places if length else (-1,):
            yield name, place, low, high


@pytest.mark.parametrize(("make", "args"), [row[1:] for row in ROWS], ids=[row[0] for row in ROWS])
def test_every_word_is_watched_at_both_of_its_ends(make, args):
    watched = make(*args)
    assert not watched.speaks()
    seen = set()
    for name, place, low, high in words_of(watched.declaration):
        for value, is_wrong in ((low, 0), (high, 0), (low - 1, 1), (high + 1, 1)):
            if -(2**31) <= value < 2**31:  # a word has 32 bits
                before = watched.put(name, place, value)
                assert watched.speaks() == is_wrong, f"{name}[{place}] = {value}"
                watched.put(name, place, before)
                seen.add((name, is_wrong))
    assert not watched.speaks()
    names = {field[0] for field in watched.declaration}
    assert seen == {(name, wrong) for name in names for wrong in (0, 1)}


def test_every_checker_of_ranges_has_a_row():
    home = Path(innervate.__file__).parent
    found = set()
    for path in home.rglob("*.py"):
        text = path.read_text(encoding="utf-8")
        watches = (
            "low[i]",
            "< low or max(",
            "low <= one <= high",
            "not within(",
            "return within(",
            "return within_spans(",
            "low <= words.min()",
        )
        if any(word in text for word in watches):
            found.add(".".join(path.relative_to(home).with_suffix("").parts))
    # Where a lost memory is put back no range is looked at; what users give is refused in a line;
    # which line put a value out of its range, in tests/running/test_blaming.py, of frames too. The
    # range that the simulators' checkers ask is in the kernel, and compiled in tests/kernel.
    others = {
        "kernel.records",
        "kernel.lowering",
        "networks.mesh.sim.orders",
        "live.declared",
        "dialect.folder",
        "scenario.declared.shared",
        "running.blaming",
        "running.sent",
        "verify.frames",
    }
    assert found - others == set(WATCHES)
