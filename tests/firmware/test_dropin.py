"""A live node's protocol as C, in Python's place: whatever it is told, it does the same."""

import asyncio
import random
import shutil
from contextlib import suppress
from importlib import import_module
from pathlib import Path
from types import SimpleNamespace

import pytest

from boards.firmware.play import Player
from innervate import scenario
from innervate.dialect import plain
from innervate.firmware import compiled, dropin
from innervate.firmware.wire import coded_of
from innervate.live.build import build
from innervate.live.declared import DeclaredStack
from innervate.live.errors import LiveError
from innervate.live.nodefile import Loaded, parse
from innervate.network import networks
from tests.live.net import Mesh
from tests.livesim import runs
from tests.recorded import calls

SEND, SET_TIMER, DELIVER = 1, 2, 3
NETWORKS = Path(__file__).parents[1] / "networks"
HURT = {"storms": 1, "storm_s": 5, "calm_s": 0}


@pytest.fixture(autouse=True)
def compiler():
    if shutil.which(compiled.COMPILER) is None:
        pytest.skip("there is no C compiler")


def fields_of(record, role_record):
    return {name: list(value) if length else value
            for name, length, *_ in role_record
            for value in (getattr(record, name),)}  # fmt: skip


def told(out, kinds):
    """What an outbox says, its frames as far as they go on the wire."""
    found = []
    for i in range(out.count[0]):
        act, frame = out.action[i], {}
        if act.kind in (SEND, DELIVER):
            record = out.frame[i]
            for name, many in (("kind", 0), *kinds[record.kind]):
                value = getattr(record, name)
                count = getattr(record, many) if isinstance(many, str) else many
                frame[name] = list(value[:count]) if many else value
        found.append((act.kind, act.a, act.b, act.c, frame))
    return found


class Enough(Exception):
    """As many calls were made as were wanted."""


class Both(Player):
    """Plays a script in plain Python, and makes each call through the drop-in, too."""

    def __init__(self, library):
        super().__init__(library)
        self.network = next(n for n in networks().values() if n.name == library.role.name)
        self.stacks, self.compared, self.most = {}, 0, 0

    def _set(self, name, slot, data):
        super()._set(name, slot, data)
        self.stacks.clear()  # they begin with what Python has

    def _call(self, slot, name, now, given):
        if self.calls == self.most:
            raise Enough
        state, gate, _ = self.nodes[slot]
        stack = self.stacks.get(slot) or self._stack(slot, state, gate)
        super()._call(slot, name, now, given)
        front = (stack.node, *((stack.gate,) if self.role.has_gate else ()), stack.params, now)
        what, record = given
        if name == "on_frame":
            frame = self._record("frame", record)
            dropin.views.copy(self.fields("frame"), frame, stack.inbox)
            record = stack.inbox
        elif name == "on_input":
            record = self._record("item", record)
        more = (record,) if name in ("on_frame", "on_input") else ()
        getattr(stack.do, name)(*front, what, *more, stack.out)
        self._compare(stack, state, gate)

    def fields(self, name):
        return dropin.records_of(self.role)[name].values()

    def _stack(self, slot, state, gate):
        frame = self.made["frame"]
        stack = SimpleNamespace(
            do=self.module, node=state, gate=gate, params=self.params[1], inbox=frame(),
            out=plain.Outbox(frame, 32), coder=None,
        )  # fmt: skip
        assert dropin.take_place(stack, self.network) == ""
        assert stack.node is not state
        self.stacks[slot] = stack
        return stack

    def _compare(self, stack, state, gate):
        where = f"call {self.calls}"
        assert fields_of(stack.node, self.role.state) == fields_of(state, self.role.state), where
        if gate is not None:
            assert fields_of(stack.gate, self.role.gate) == fields_of(gate, self.role.gate), where
        assert stack.out.overflow[0] == self.out.overflow[0] == 0
        assert told(stack.out, self.role.kinds) == told(self.out, self.role.kinds), where
        self.compared += 1


def play(name, simulated, drawn):
    """Play so many of the calls that are recorded, and so many that are drawn."""
    record, script = calls.kept(name), calls.told(name)
    both = Both(calls.library(name))
    for most, part in (
        (simulated, script[: record.kept + record.runs[0].size]),
        (simulated + drawn, calls.pieces(0, 1 + drawn // calls.PIECE)),
    ):
        both.most = most
        with suppress(Enough):
            for _ in both.play(part):
                pass
    assert both.compared == both.calls == simulated + drawn


def test_every_call_of_a_cell_does_what_it_does_in_python():
    play("skin", 3000, 3000)


def test_so_does_every_call_of_a_router():
    play("mesh", 350, 150)


@pytest.mark.slow
def test_so_do_thousands_of_them():
    play("mesh", 5000, 10_000)


class Lockstep:
    """Two nodes on a cable that takes no time, in a clock of its own; all that they say."""

    def __init__(self, network, in_c):
        plan = scenario.plan(scenario.from_dict({"kind": network.name, "nodes": 2}))
        self.stacks, self.said, self.wire, self.due = [], [], [], {}
        for number in (0, 1):
            stack = DeclaredStack(network, number, plan.params, 7 * number + 5, [0])
            if in_c:
                assert dropin.take_place(stack, network) == ""
            self.stacks.append(stack)

    def drain(self, at, now):
        out = self.stacks[at].out
        for i in range(out.count[0]):
            act = out.action[i]
            if act.kind == SET_TIMER:
                self.due[at, act.a] = act.b
            elif act.kind == SEND:
                self.wire.append((1 - at, self.stacks[at].encode(out.frame[i])))
            self.said.append((now, at, act.kind, act.a, act.b, act.c, self.wire[-1:]))
        out.count[0] = 0

    def run(self, until_us):
        for at in (0, 1):
            self.stacks[at].on_start(1, 0)
            self.drain(at, 1)
        while True:
            now, (at, timer) = min((when, which) for which, when in self.due.items())
            if now > until_us:
                return self.said, [stack.status(now) for stack in self.stacks]
            del self.due[at, timer]
            self.stacks[at].on_timer(now, timer)
            self.drain(at, now)
            while self.wire:
                at, data = self.wire.pop(0)
                if self.stacks[at].decode(data) == 0:
                    self.stacks[at].on_frame(now, 0)
                    self.drain(at, now)


@pytest.mark.parametrize(("name", "until_us"), [("tokenring", 400_000), ("babel", 6_000_000)])
def test_any_network_over_cables_has_it(name, until_us, monkeypatch):
    """One that only declares its protocol; one whose packets are no frames of its layouts."""
    monkeypatch.setenv("INNERVATE_NETWORKS", str(NETWORKS / "tokenring"))
    networks.cache_clear()
    network = networks()[name]
    plain_said, plain_knows = Lockstep(network, False).run(until_us)
    said, knows = Lockstep(network, True).run(until_us)
    assert len(said) > 50
    assert said == plain_said
    assert knows == plain_knows
    monkeypatch.undo()
    networks.cache_clear()


@pytest.fixture
def ring(monkeypatch):
    """The stacks of a node of the token ring, in Python and as C."""
    monkeypatch.setenv("INNERVATE_NETWORKS", str(NETWORKS / "tokenring"))
    networks.cache_clear()
    network = networks()["tokenring"]
    made = [DeclaredStack(network, 0, {"hold_us": 9, "lost_us": 99}, 5, [0, 1]) for _ in range(2)]
    assert dropin.take_place(made[1], network) == ""
    yield made
    monkeypatch.undo()
    networks.cache_clear()


def said(stack):
    """What a call came to: its outbox with all of its frames, their bytes or why none, the node."""
    fields, found = stack.network.fields, []
    for i in range(stack.out.count[0]):
        act, data = stack.out.action[i], b""
        frame = fields_of(stack.out.frame[i], fields.FRAME) if act.kind in (SEND, DELIVER) else {}
        if act.kind == SEND:
            try:
                data = stack.encode(stack.out.frame[i])
            except ValueError as error:
                data = str(error)
        found.append((act.kind, act.a, act.b, act.c, frame, data))
    stack.out.count[0] = 0
    return found, fields_of(stack.node, fields.STATE)


def test_values_out_of_their_ranges_are_what_they_are_in_python_call_by_call(ring):
    """What a wire cannot carry is not sent, with the same words; and counters go on."""
    draw, refused, passed = random.Random(7), 0, 0
    for number in range(700):
        name, kind = draw.choice([("on_timer", 0), ("on_timer", 1), ("on_input", 0),
                                  ("on_frame", 0)])  # fmt: skip
        load = [draw.choice([3, 255, 256, 70_000, -1]) for _ in range(2)]
        lap, made_at = draw.choice([1, 65_536]), draw.choice([5, -9])
        told = []
        for stack in ring:
            record = stack.inbox if name == "on_frame" else stack.item
            record.kind, record.lap, record.made_at = 1, lap, made_at
            record.load[:] = load
            if name == "on_frame":
                stack.node.lap = lap  # or it would be dropped
                stack.on_frame(number, kind)
            elif name == "on_input":
                stack.on_input(number, kind, record)
            else:
                stack.on_timer(number, kind)
            told.append(said(stack))
        assert told[1] == told[0], (number, name)
        refused += sum(one[5] == "load does not fit into its bits" for one in told[0][0])
        passed = told[0][1]["passed"]
    assert (refused > 50, passed > 256) == (True, True)


def test_a_kind_that_no_layout_has_is_refused_in_the_words_of_python(ring):
    for kind in (2, 17, 257, -1):  # the lowest bits of two of them are a token's
        for stack in ring:
            frame = stack.out.frame[0]
            frame.kind = kind
            with pytest.raises(ValueError, match=r"^no frame has this kind$"):
                stack.encode(frame)


def node_of(kind, tmp_path, **keys):
    link = {"kind": "udp", "bind": "127.0.0.1:0", "peers": ["127.0.0.1:9"]}
    table = parse({"kind": kind, "number": 0, "nodes": 2, **keys, "link": [link]})
    return build(Loaded(table, tmp_path / "n0.toml"))


def libraries():
    return sorted((compiled.cache_root() / compiled.FOLDER).glob("*.so"))


@pytest.mark.parametrize(("kind", "given"), [("mesh", {"in_c": 1}), ("mesh", {"mtu": 1200}),
                                             ("skin", {})])  # fmt: skip
def test_a_hurt_network_does_the_same_to_the_last_byte(kind, given):
    """All nodes, or every other one, as C: as those in Python, bytes and times of all datagrams."""
    small = {"nodes": 6, "rate": 5} if kind == "mesh" else {"columns": 2, "rows": 2}
    given = {**HURT, **small, "in_c": 2, **given}
    found = runs.run(5, kind, **given)
    assert found.broken == []
    assert found == runs.run(5, kind, **given | {"in_c": 0})
    assert found.told.get("delivered", found.told.get("touches")) > 20


def test_nodes_of_both_kinds_stand_in_one_mesh_and_go_round_what_is_cut():
    async def main():
        mesh = Mesh(4, [(0, 1), (1, 2), (2, 3), (3, 0)])
        for node in mesh.nodes[::2]:
            assert dropin.take_place(node.stack, networks()["mesh"]) == ""
        async with mesh:
            for a, b in ((0, 1), (2, 3)):
                mesh.cut(a, b)
                for sender in range(4):
                    for other in range(4):
                        receipt = mesh.nodes[sender].send_message(other, bytes([a, sender]))
                        assert await receipt.wait() == "delivered"
                mesh.cut(a, b, cut=False)
            return [node.status() for node in mesh.nodes]

    told = asyncio.run(main())
    assert [len(one["neighbours"]) for one in told] == [2, 2, 2, 2]
    assert all(one["gateway"] == 0 and len(one["routes"]) == 3 for one in told)


def test_status_says_what_a_protocol_runs_in(tmp_path):
    for engine, told in (("python", "python"), ("c", "c"), ("auto", "c")):
        assert node_of("mesh", tmp_path, engine=engine).status()["engine"] == told


def test_a_library_is_kept_and_one_of_other_sources_is_never_taken(tmp_path, monkeypatch):
    monkeypatch.setenv("INNERVATE_CACHE", str(tmp_path))
    assert node_of("skin", tmp_path, engine="c").not_in_c == ""
    (made,) = libraries()
    before = made.stat().st_ino
    assert node_of("skin", tmp_path, engine="c").not_in_c == ""
    assert made.stat().st_ino == before  # not made anew
    key = compiled.key_of
    monkeypatch.setattr(compiled, "key_of", lambda *of: key(*of)[::-1])
    stale = made.rename(made.with_stem(made.stem[::-1])).stat().st_ino  # as if sources had changed
    assert node_of("skin", tmp_path, engine="c").not_in_c == ""
    assert libraries()[0].stat().st_ino != stale


def test_a_library_that_somebody_else_could_have_written_is_not_taken(tmp_path, monkeypatch):
    monkeypatch.setenv("INNERVATE_CACHE", str(tmp_path))
    assert node_of("skin", tmp_path, engine="c").not_in_c == ""
    (made,) = libraries()
    before = made.stat().st_ino
    made.chmod(0o722)
    assert node_of("skin", tmp_path, engine="c").not_in_c == ""
    assert libraries()[0].stat().st_ino != before


def test_a_hash_is_of_all_that_has_a_part_in_it(monkeypatch):
    role = calls.library("skin").role
    was = compiled.key_of(role, None)
    assert compiled.key_of(role, None) == was
    assert compiled.key_of(role._replace(room=13), None) != was
    assert compiled.key_of(role, coded_of(role, networks()["skin"])) != was
    monkeypatch.setattr(import_module("innervate.networks.skin.protocol.route"), "INFINITY", 254)
    assert compiled.key_of(role, None) != was
    monkeypatch.undo()
    assert compiled.key_of(role, None) == was
    monkeypatch.setattr(compiled, "MAKERS", ("dialect", "wire"))
    assert compiled.key_of(role, None) != was


def test_without_a_compiler_python_does_it_and_says_so(tmp_path, monkeypatch):
    monkeypatch.setenv("INNERVATE_CACHE", str(tmp_path))
    monkeypatch.setattr(compiled, "COMPILER", "no-compiler-is-called-so")
    node = node_of("mesh", tmp_path, engine="auto")
    assert node.status()["engine"] == "python"
    assert node.not_in_c.startswith("no-compiler-is-called-so is missing; install it")
    with pytest.raises(LiveError, match=r'engine = "c": no-compiler.*; or write engine = "auto"'):
        node_of("mesh", tmp_path, engine="c")


def test_what_has_no_c_runs_in_python(tmp_path):
    """The PC of a skin."""
    assert node_of("skin", tmp_path, role="sink", engine="auto").status()["engine"] == "python"
    with pytest.raises(LiveError, match="there is no C of what it runs"):
        node_of("skin", tmp_path, role="sink", engine="c")
