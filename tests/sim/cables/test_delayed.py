"""Frames sent with a delay, of one protocol: in a run, explored, and by a live node."""

import asyncio

import pytest

import innervate
from innervate import scenario as scenarios
from innervate.live.build import build
from innervate.live.nodefile import load
from innervate.network import networks
from innervate.topology import free_graph
from innervate.verify.declared import Net
from innervate.verify.states import Budget, most_frames
from tests.fixtures.node_files import LINK
from tests.live import time_by_hand
from tests.own import alone, made

__all__ = ["alone"]
DELAY_US = 20_000
PROTOCOL = f'''"""Node 0 sends a frame as it is first switched on, {DELAY_US} us later."""

from innervate.dialect.arith import MASK30
from innervate.dialect.outbox import send, set_timer

TIMERS = 1


def on_start(node, params, now, cause, out):
    """Send it."""
    set_timer(out, 0, (now + 500_000) & MASK30)
    if node.number == 0 and cause == 0:
        out.frame[send(out, 0, {DELAY_US}, 0)].kind = 1


def on_frame(node, params, now, port, frame, out):
    """It came."""
    node.got = 1


def on_timer(node, params, now, timer, out):
    """Time passes."""


def on_input(node, params, now, kind, item, out):
    """Nobody says anything."""
'''
FIELDS = '''"""What nodes and frames hold."""

STATE = (("number", 0, 0, 65535, "node", "who we are"), ("got", 0, 0, 1, "flag", "it came"))
FRAME = (("kind", 0, 0, 3, "type", "1 late"),)
PARAMS = ()
'''
FRAMES = '"""Frames."""\n\nKIND_BITS = 4\nLAYOUTS = ((1, "late", ()),)\n'
NETWORK = '''"""What the toolkit is told."""

from innervate import Network

NETWORK = Network("late", __package__, medium="cables", protocol="protocol", fields="fields",
                  frames="frames")
'''
SCENARIO = """
kind = "late"
cables = ["n0.W-n1.W", "n0.E-n1.E"]
duration_s = 0.2

[links]
latency_us = [100, 100]
"""


@pytest.fixture
def late(alone, capsys):
    own = made(alone / "late")
    for file, text in (("protocol.py", PROTOCOL), ("fields.py", FIELDS), ("frames.py", FRAMES),
                       ("network.py", NETWORK), ("late.toml", SCENARIO)):  # fmt: skip
        (own.folder / file).write_text(text)
    for file in ("invariants.py", "test_late.py"):
        (own.folder / file).unlink()
    capsys.readouterr()
    scenarios.load(own.scenario)  # and with it its folder
    return own


def events(*actions):
    return [{"at_s": 0.005 + 0.001 * at, "action": action, "node": 0}
            for at, action in enumerate(actions)]  # fmt: skip


@pytest.mark.parametrize(("actions", "arrives"), [
    ((), True), (("kill",), False), (("restart",), False), (("kill", "revive"), False),
    (("restart", "restart"), False),
])  # fmt: skip
def test_in_a_run_it_is_lost_with_the_memory_of_its_node(late, actions, arrives):
    run = innervate.run(late.scenario, overrides={"event": events(*actions)}, plain=True)
    frames = run.summary["frames"]
    assert (frames["sent"], frames["arrived"], frames["lost"]) == (1, arrives, not arrives)
    assert frames["lost_by"].get("off", 0) == (not arrives)
    assert run.result.world.cells[1].got == arrives


def test_explored_it_leaves_at_its_time_or_is_lost_with_the_memory_of_its_node(late):
    network = networks()["late"]
    net = Net(network.protocol, network.fields, free_graph([("n0.W", "n1.W")]), {})
    begun = net.begin(Budget(loss=0, restart=1, input=0)).state
    assert not any(begun.ways)
    assert begun.nodes[0].late == ((DELAY_US, 0, (1,)),)
    after = {step.words: step.state for step in net.steps(begun)}
    assert set(after) == {"A delayed frame of n0 leaves", "Timer 0 of n1 fires",
                          "n0 loses its memory", "n1 loses its memory"}  # fmt: skip
    left = after["A delayed frame of n0 leaves"]
    assert left.ways[0] == ((1,),)
    assert left.nodes[0].late == ()
    assert left.nodes[0].timers == ((0, 500_000 - DELAY_US),)  # so much of its time has passed
    assert after["n0 loses its memory"].nodes[0].late == ()
    assert after["n1 loses its memory"].nodes[0].late == begun.nodes[0].late


def test_an_exploration_holds_back_as_many_frames_for_a_port_as_it_has_on_a_cable(late):
    """Frames for ports without a cable leave nowhere, whenever."""
    path = late.folder / "protocol.py"
    once = f"out.frame[send(out, 0, {DELAY_US}, 0)].kind = 1"
    each = f"for p in range(12):\n            out.frame[send(out, p % 4, {DELAY_US}, 0)].kind = 1"
    path.write_text(
        path.read_text().replace(once, each).replace("TIMERS = 1", "TIMERS = 1\nOUTBOX = 16")
    )
    scenarios.load(late.scenario)
    network = networks()["late"]
    net = Net(
        network.protocol, network.fields, free_graph([("n0.W", "n1.W"), ("n0.E", "n1.E")]), {}
    )
    begun = net.begin(Budget()).state
    assert [port for _, port, _ in begun.nodes[0].late] == [0, 1, 0, 1, 0, 1]
    assert most_frames(begun) == 3


NODE = f'kind = "late"\nnumber = 0\n{LINK}'


@pytest.mark.parametrize(("off_s", "sent"), [(None, 1), (DELAY_US / 2e6, 0)])
def test_a_live_node_sends_it_at_its_time_or_is_off_by_then(late, tmp_path, off_s, sent):
    path = tmp_path / "n0.toml"
    path.write_text(NODE)

    async def main():
        node, told = build(load(path)), []
        node.taps.append(lambda _ns, port, out, _data, why: told.append((port, out, why)))
        await node.start()
        await asyncio.sleep(DELAY_US / 1e6 - 0.001 if off_s is None else off_s)
        assert told == []
        if off_s is not None:
            await node.stop()
        await asyncio.sleep(0.1)
        if off_s is None:
            await node.stop()
        return told

    assert time_by_hand.run(main()) == [(0, True, "")] * sent
