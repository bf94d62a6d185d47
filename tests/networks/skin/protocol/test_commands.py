"""Commands go down over children: each cell gets one once, whatever the children say."""

from collections import deque

from hypothesis import example, given, settings
from hypothesis import strategies as st

from innervate.dialect import plain
from innervate.dialect.outbox import DELIVER, REPORT, SEND
from innervate.networks.skin.protocol import cell as skin
from innervate.networks.skin.protocol import fields as skin_fields
from innervate.networks.skin.protocol import sink as skin_sink
from innervate.networks.skin.protocol.command_window import WINDOW, accept_command
from innervate.networks.skin.protocol.constants import COMMAND, EVERYBODY, GIVE, ONE, PORTS

Frame = plain.make("Frame", skin_fields.FRAME)
Cell = plain.make("Cell", skin_fields.CELL)
DEPTH = 20


class Cells:
    """Cells on any cables, and who takes whom for a child; frames come in any order."""

    def __init__(self, count, cables):
        self.params = plain.make("Params", skin_fields.PARAMS)()
        self.params.max_depth = DEPTH
        self.out = plain.Outbox(Frame, 16)
        self.cells = [Cell() for _ in range(count)]
        self.peer = {}
        for number, cell in enumerate(self.cells):
            cell.number = number
        used = [0] * count
        for a, b, child_a, child_b in cables:
            if a != b and used[a] < PORTS and used[b] < PORTS:
                self.peer[a, used[a]], self.peer[b, used[b]] = (b, used[b]), (a, used[a])
                self.cells[a].child[used[a]] = child_b
                self.cells[b].child[used[b]] = child_a
                used[a] += 1
                used[b] += 1
        self.wires = deque()
        self.came = []
        self.handled = 0

    def put(self, number, cell=EVERYBODY, at=0, hops=0):
        """A command comes to a cell from outside."""
        frame = Frame()
        frame.kind, frame.cell, frame.sq, frame.hops = COMMAND, cell, number, hops
        self.wires.append((at, PORTS - 1, frame))

    def run(self, choose):
        """Until nothing is on its way; `choose(n)` picks which frame comes next."""
        while self.wires:
            self.wires.rotate(-choose(len(self.wires)))
            node, port, frame = self.wires.popleft()
            self.handled += 1
            skin.on_frame(self.cells[node], self.params, 0, port, frame, self.out)
            for i in range(self.out.count[0]):
                act = self.out.action[i]
                kept = Frame()
                skin.copy_frame(kept, self.out.frame[i])
                if act.kind == SEND and (node, act.a) in self.peer:
                    self.wires.append((*self.peer[node, act.a], kept))
                elif act.kind == DELIVER:
                    self.came.append((node, kept.sq))
            self.out.count[0] = 0


CABLE = st.tuples(
    st.integers(0, 9), st.integers(0, 9), st.integers(0, 1), st.integers(0, 1)
)  # fmt: skip


@given(st.lists(CABLE, max_size=24), st.lists(st.integers(0, 9), min_size=1, max_size=5), st.data())
@settings(max_examples=200)
def test_no_cell_gets_a_command_twice_even_where_children_close_rings(cables, entries, data):
    net = Cells(10, cables)
    for number, at in enumerate(entries):
        net.put(number, at=at)
        net.put(number, at=(at + 1) % 10)  # a copy over another way
    net.run(lambda n: data.draw(st.integers(0, n - 1)))
    assert len(net.came) == len(set(net.came))
    # Each cell hands a command on once, to at most three others.
    assert net.handled <= len(entries) * (2 + 10 * 3)


def tree(count):
    """A chain of parents: every cell is the child of the one at half its number."""
    return [((cell - 1) // 2, cell, 0, 1) for cell in range(1, count)]


def test_everybody_in_a_tree_gets_a_command_once_and_so_does_a_single_cell():
    net = Cells(10, tree(10))
    net.put(1)
    net.run(lambda n: n - 1)
    assert sorted(net.came) == [(cell, 1) for cell in range(10)]
    assert net.handled == 10
    net.came.clear()
    net.put(2, cell=7)
    net.run(lambda n: 0)
    assert net.came == [(7, 2)]


def test_a_command_goes_no_further_than_a_route_can_and_not_over_a_broken_port():
    net = Cells(3, tree(3))
    net.put(1, hops=DEPTH)
    net.run(lambda n: 0)
    assert net.came == [(0, 1)]
    net.cells[0].pf[0] = ONE
    net.put(2)
    net.run(lambda n: 0)
    assert sorted(net.came[1:]) == [(0, 2), (2, 2)]


@example([-1, 0], 65_513)  # a cell that was just started, and the PC's numbers near their end
@given(st.lists(st.integers(-WINDOW + 1, WINDOW - 1), max_size=40), st.integers(0, 65_535))
def test_a_number_counts_once_in_any_order_within_the_window(steps, start):
    cell, seen, newest = Cell(), set(), start
    for step in [0, *steps]:
        number = (newest + step) & 0xFFFF
        assert bool(accept_command(cell, number)) == (number not in seen)
        seen.add(number)
        if step > 0:
            newest = number
        seen = {n for n in seen if ((newest - n) & 0xFFFF) < WINDOW}
        assert 0 < cell.commands < 1 << WINDOW


def test_a_pc_that_counts_anew_is_heard():
    cell = Cell()
    assert all(accept_command(cell, number) for number in range(60_000, 60_050))
    assert accept_command(cell, 12_345)
    assert not accept_command(cell, 12_345)


class Pc:
    """The PC with three interface ports; two of them have a child."""

    def __init__(self, now):
        self.params = plain.make("Params", skin_fields.PARAMS)()
        self.out = plain.Outbox(Frame, 16)
        self.pc = plain.make("Pc", (("own", 1, 0, 0, "", ""),), skin_fields.SINK_PORT, ports=3)()
        self.pc.own = [plain.make("Sink", skin_fields.SINK)()]
        self.pc.own[0].ports = 3
        skin_sink.on_start(self.pc, self.params, now, 0, self.out)
        self.out.count[0] = 0
        self.pc.size = [4, 0, 1]

    def give(self):
        """(port, number) of every copy of a command."""
        item = Frame()
        item.cell, item.dist, item.proximity = 7, 3, 500
        skin_sink.on_input(self.pc, self.params, 0, GIVE, item, self.out)
        acts = [(self.out.action[i], self.out.frame[i]) for i in range(self.out.count[0])]
        self.out.count[0] = 0
        assert all(act.kind != REPORT for act, _ in acts)
        assert all((f.kind, f.cell, f.dist, f.proximity, f.hops) == (COMMAND, 7, 3, 500, 0)
                   for _, f in acts)  # fmt: skip
        return [(act.a, frame.sq) for act, frame in acts]


def test_the_pc_sends_a_command_to_every_child_with_a_number_of_its_own():
    pc = Pc(0)
    assert pc.give() == [(0, 1), (2, 1)]
    assert pc.give() == [(0, 2), (2, 2)]


def test_a_restarted_pc_does_not_count_where_it_was():
    before, after = Pc(1_000_000), Pc(3_000_000)
    apart = (after.give()[0][1] - before.give()[0][1]) & 0xFFFF
    assert WINDOW < apart < 65_536 - WINDOW
