"""How long `live up` keeps a network, what it says of it, and what is left of it."""

import asyncio
import io
import json
import os
import signal
import socket
import sys
from contextlib import ExitStack, suppress
from itertools import pairwise
from pathlib import Path
from types import SimpleNamespace

import pytest

from innervate import scenario as scenarios
from innervate.live import machine, run_up, tap, up
from innervate.live.errors import LiveError
from innervate.live.notices import Notices
from innervate.live.play import Event
from innervate.live.run_up import Way
from tests.live import time_by_hand

RING = {"kind": "mesh", "nodes": 3, "radio": {"profile": "ip"},
        "link": [{"a": 0, "b": 1}, {"a": 1, "b": 2}]}  # fmt: skip


def kept(limit_s, plays_s, stopped_s=None, error=None):
    """How long a network is kept that is played on for so long, and told to end at a time."""

    async def main():
        loop, ending = asyncio.get_running_loop(), asyncio.Event()
        began, cancelled = loop.time(), []

        async def play():
            try:
                await asyncio.sleep(plays_s)
            except asyncio.CancelledError:
                cancelled.append(round(loop.time() - began, 3))
                raise
            if error is not None:
                raise error

        if stopped_s is not None:
            loop.call_later(stopped_s, ending.set)
        watch = SimpleNamespace(monotonic=lambda: loop.time())
        run_up.time, real = watch, run_up.time
        try:
            await run_up._until(ending, asyncio.ensure_future(play()), limit_s)
        finally:
            run_up.time = real
        return round(loop.time() - began, 3), cancelled

    return time_by_hand.run(main())


@pytest.mark.parametrize(
    ("limit_s", "plays_s", "stopped_s", "ends_s", "cancelled"),
    [
        (5.0, 2.0, None, 5.0, []), (5.0, 9.0, None, 5.0, [5.0]), (5.0, 2.0, 3.0, 3.0, []),
        (0.0, 2.0, 30.0, 30.0, []), (0.0, 90.0, 30.0, 30.0, [30.0]), (5.0, 9.0, 1.0, 1.0, [1.0]),
    ],
)  # fmt: skip
def test_a_network_is_kept_until_its_time_is_over_or_somebody_ends_it(
    limit_s, plays_s, stopped_s, ends_s, cancelled
):
    assert kept(limit_s, plays_s, stopped_s) == (ends_s, cancelled)


def test_an_event_that_goes_wrong_ends_it_at_once():
    with pytest.raises(LiveError, match="n2 ended"):
        kept(50.0, 1.0, error=LiveError("n2 ended: no message"))


@pytest.fixture
def plan():
    return scenarios.plan(scenarios.from_dict(RING))


def test_keys_are_those_that_were_asked_for(plan, tmp_path):
    sealed = [run_up.prepared(plan, Way(tmp_path / "a", "udp", "key")).keys for _ in range(2)]
    assert [keys["use"] for keys in sealed] == [1, 1]
    assert all(len(bytes.fromhex(keys["secret.1"])) == 32 for keys in sealed)
    assert sealed[0] != sealed[1]
    assert run_up.prepared(plan, Way(tmp_path / "a", "udp", "")).keys is None
    for _ in range(2):  # of a run before nobody is left
        network = run_up.prepared(plan, Way(tmp_path / "b", "udp", "identities", engine="c"))
    assert network.keys == {"identity": "keys/n{number}.identity"}
    assert network.engine == "c"
    files = {path.name for path in (tmp_path / "b" / "keys").iterdir()}
    assert files >= {f"n{number}.identity" for number in range(3)}


@pytest.mark.parametrize("keys", ["key", "identities"])
def test_a_channel_has_no_keys_and_no_folder_is_left(monkeypatch, tmp_path, keys):
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    team = scenarios.plan(scenarios.from_dict({"kind": "radio", "stations": 3}))
    with pytest.raises(LiveError, match="--sealed and --identities out"):
        run_up.prepared(team, Way(None, "udp", keys))
    assert list(tmp_path.iterdir()) == []


def test_where_nothing_can_be_played_no_folder_is_left(plan, monkeypatch, tmp_path):
    def no(*_):
        raise LiveError("no cable joins n0 and n2")

    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    monkeypatch.setattr(run_up, "_player", no)
    with pytest.raises(LiveError, match="no cable joins"):
        asyncio.run(run_up.run(plan, Way(None, "udp", ""), "", 0, as_json=True))
    assert list(tmp_path.iterdir()) == []


def test_nobodys_own_keys_or_scenario_are_replaced(plan, tmp_path):
    way = Way(tmp_path, "udp", "identities")
    (tmp_path / "keys").mkdir()
    (tmp_path / "keys" / "authority.key").write_text("mine")
    with pytest.raises(LiveError, match="holds keys that live up did not make"):
        run_up.prepared(plan, way)
    assert (tmp_path / "keys" / "authority.key").read_text() == "mine"
    way = Way(tmp_path, "udp", "")
    mine = tmp_path / "scenario.toml"
    for text, is_taken in (("# mine", False), (f"{run_up.OURS}\nkind = 'mesh'", True)):
        mine.write_text(text)
        if is_taken:
            run_up.prepared(plan, way)
        else:
            with pytest.raises(LiveError, match="none that live up wrote"):
                run_up.prepared(plan, way)
        assert mine.read_text() == text


def test_a_socket_is_left_once_nobody_listens_and_not_while_its_node_is_only_busy(tmp_path):
    path = tmp_path / "n1.sock"

    def seen():
        return machine.is_left(path), machine.answers(path)

    assert seen() == (False, False)
    with socket.socket(socket.AF_UNIX) as node, ExitStack() as callers:
        node.bind(str(path))
        node.listen(1)
        assert seen() == (False, True)
        with suppress(BlockingIOError):
            while True:
                caller = callers.enter_context(socket.socket(socket.AF_UNIX))
                caller.setblocking(False)
                caller.connect(str(path))
        assert seen() == (False, False)
    assert seen() == (True, False)


@pytest.mark.parametrize("name", ["n1", "c7"])
def test_sockets_of_nodes_that_were_killed_go_and_whoever_runs_there_refuses(plan, tmp_path, name):
    way = Way(tmp_path, "udp", "")
    with socket.socket(socket.AF_UNIX) as left:
        left.bind(str(tmp_path / f"{name}.sock"))
        left.listen()
        with pytest.raises(LiveError, match=f"{name} of another network runs here"):
            run_up.prepared(plan, way)
        assert len(list(tmp_path.glob("*.sock"))) == 1
    run_up.prepared(plan, way)
    assert list(tmp_path.glob("*.sock")) == []


def test_only_a_folder_that_was_made_for_it_is_removed(plan, tmp_path):
    for folder in (None, tmp_path / "own"):
        way = Way(folder, "udp", "")
        network = run_up.prepared(plan, way)
        network.folder.mkdir(exist_ok=True)
        asyncio.run(run_up.down(network, way))
        assert network.folder.exists() == (folder is not None)


@pytest.mark.parametrize(("nodes", "absent", "keys", "words"), [
    (50, 0, None, ""), (51, 1, None, ""),
    (51, 0, None, "starting 51 processes, one a node, which hold about 1.4 GB; Ctrl-C ends them. "),
    (206, 1, {"use": 1}, "starting 205 processes, one a node, which hold about 7.0 GB"),
])  # fmt: skip
def test_many_processes_are_foretold_with_a_smaller_network_to_try(
    nodes, absent, keys, words, capsys
):
    names = [f"c{k}" for k in range(nodes)]
    run_up._foretell(SimpleNamespace(names=names, absent=set(names[:absent]), keys=keys))
    out, err = capsys.readouterr()
    assert out == "", "what programs read stays as it is"
    assert err.startswith(words)
    assert bool(err) == bool(words)
    if err:
        assert err.endswith("A smaller one to try: innervate live up line\n")


def test_what_is_up_is_said_to_people_and_to_programs(capsys):
    pids = {f"n{k}": SimpleNamespace(pid=70 + k) for k in range(2)}
    network = SimpleNamespace(
        names=["n0", "n1", "n2"], absent={"n2"}, links=[(0, 1)], folder=Path("/run"),
        processes=pids, socket=lambda name: Path(f"/run/{name}.sock"),
    )  # fmt: skip
    run_up._announce(network, 1.26, as_json=False)
    said = capsys.readouterr().out.splitlines()
    assert said[0] == "2 nodes and 1 cables are up after 1.3 s; Ctrl-C ends them."
    assert said[-1] == "They are in INNERVATE_RUN=/run"
    network.links = []
    run_up._announce(network, 1.0, as_json=False)
    assert "2 nodes and their channel are up" in capsys.readouterr().out
    run_up._announce(network, 1.23456, as_json=True)
    told = json.loads(capsys.readouterr().out)
    assert (told["folder"], told["up_s"]) == ("/run", 1.235)
    assert told["nodes"] == {
        name: {"pid": pid.pid, "socket": f"/run/{name}.sock"} for name, pid in pids.items()
    }


@pytest.mark.parametrize("as_json", [False, True])
def test_events_are_said_as_they_happen_and_what_is_not_played_at_once(
    plan, capsys, monkeypatch, as_json
):
    happening = [Event(0.5, "cut", 0, "", 0.0, "cut n0 - n1"), Event(2.0, "jam", -1, "n1", 0.0, "")]
    monkeypatch.setattr(run_up.play, "events", lambda _: happening)
    player = run_up._player(SimpleNamespace(deployment=None), as_json)
    assert capsys.readouterr().err == "not played: jam at 2 s\n"
    player.tell(happening[0])
    out = capsys.readouterr().out
    if as_json:
        assert json.loads(out) == {"at_s": 0.5, "event": "cut n0 - n1"}
    else:
        assert out == "0.5 s: cut n0 - n1\n"
    raw = io.BytesIO()
    monkeypatch.setattr(sys, "stdout", io.TextIOWrapper(raw))
    player.tell(happening[0])
    assert raw.getvalue().decode() == out  # at once, into a pipe as well


def test_frames_are_told_in_order_and_in_lines_of_a_bounded_length():
    class Node:
        name, sealer, taps, paths = "n0", None, [], []
        stack = SimpleNamespace(status=lambda now: {"kind": "mesh", "role": "node", "number": 4})

    class Writer:
        def __init__(self, lines):
            self.lines = lines

        async def line(self, answer):
            self.lines.append(answer)

    async def main():
        told = []
        task = asyncio.ensure_future(tap.serve(Node, Writer(told)))
        await asyncio.sleep(0)
        await asyncio.sleep(0)
        (take,) = Node.taps
        for at_ns in range(2 * tap.BATCH, -1, -1):
            take(at_ns, 1, True, b"\xff", "why")
        for _ in range(10):
            await asyncio.sleep(0)
        for _ in range(tap.PENDING_MAX + 3):
            take(0, 0, False, b"", "")
        for _ in range(500):
            await asyncio.sleep(0)
        task.cancel()
        await asyncio.gather(task, return_exceptions=True)
        return told

    head, *lines = asyncio.run(main())
    assert (head["capturing"], head["number"], head["sealed"]) == ("n0", 4, False)
    first, rest = lines[:3], lines[3:]
    assert [len(line["frames"]) for line in first] == [tap.BATCH, tap.BATCH, 1]
    frames = [frame for line in first for frame in line["frames"]]
    assert all(a[0] < b[0] for a, b in pairwise(frames))
    assert frames[0] == (0, 1, True, "ff", "why")
    assert [line["missed"] for line in rest][:2] == [3, 0]
    assert sum(line["missed"] for line in lines) == 3
    assert sum(len(line["frames"]) for line in rest) == tap.PENDING_MAX
    assert Node.taps == []


def test_each_matter_is_said_at_its_own_times_and_what_was_not_said_is_not_over():
    said, now = [], [0.0]
    notices = Notices(said.append, period_s=60.0, clock=lambda: now[0])
    for at, matter in ((0.0, "a"), (30.0, "b"), (59.9, "a"), (60.0, "a"), (89.0, "b"), (90.0, "b")):
        now[0] = at
        notices.tell(matter, f"{matter} at {at:g}")
    assert said == ["a at 0", "b at 30", "a at 60", "b at 90"]
    notices.over("c", "never said")
    notices.over("a", "a is over")
    notices.over("a", "again")
    notices.tell("a", "too soon")
    notices.over("a", "not said, so not over")
    assert said[4:] == ["a is over"]


def test_ctrl_c_before_all_are_up_interrupts_and_no_node_is_said_to_have_ended(
    plan, tmp_path, monkeypatch
):
    async def starts(network, scenario):  # as a terminal tells: this process, and each node's
        os.kill(os.getpid(), signal.SIGINT)
        raise LiveError("c0 ended: innervate: interrupted")

    monkeypatch.setattr(run_up, "up", starts)
    with pytest.raises(KeyboardInterrupt):
        asyncio.run(run_up.run(plan, Way(tmp_path / "run", "udp", ""), "", 0.0, False))


@pytest.mark.parametrize(("answers_s", "waited_s"), [(60.0, 60.0), (1e9, 150.0)])
def test_of_many_nodes_that_start_at_once_the_first_has_as_much_longer(
    tmp_path, monkeypatch, answers_s, waited_s
):
    """Sixty on two cores beside other work took 44 s."""
    many = {"kind": "mesh", "nodes": 60, "link": [{"a": k, "b": k + 1} for k in range(59)]}
    network = up.Processes(scenarios.plan(scenarios.from_dict(many)), tmp_path, "udp")
    network.processes["n0"] = SimpleNamespace(poll=lambda: None)

    async def main():
        loop = asyncio.get_running_loop()
        began = loop.time()
        monkeypatch.setattr(up, "time", SimpleNamespace(monotonic=loop.time))
        monkeypatch.setattr(up.status, "answers", lambda _: loop.time() - began >= answers_s)
        with suppress(LiveError):
            await network._ready(["n0"])
        return loop.time() - began

    assert time_by_hand.run(main()) == pytest.approx(waited_s, abs=0.1)


def test_a_node_that_ends_by_itself_is_said(plan, tmp_path, monkeypatch):
    async def starts(network, scenario):
        raise LiveError("c0 ended: no message")

    monkeypatch.setattr(run_up, "up", starts)
    with pytest.raises(LiveError, match="c0 ended: no message"):
        asyncio.run(run_up.run(plan, Way(tmp_path / "run", "udp", ""), "", 0.0, False))
