"""live_up(scenario): a scenario's nodes as processes, held by a program."""

import asyncio
import os
import time
from pathlib import Path
from types import SimpleNamespace

import pytest

import innervate
from innervate import Mesh, Skin
from innervate import scenario as scenarios
from innervate.live import up

SKIN = Skin(
    patch=[Skin.Patch(columns=2, rows=1)],
    interface=[Skin.Interface(row=0, column=0, port="W")],
    event=[Skin.Event(at_s=0.1, action="cut", interface=0)],
)
PAIR = Mesh(
    node=[Mesh.Node(x_m=0.0, y_m=0.0), Mesh.Node(x_m=5.0, y_m=0.0)],
    link=[Mesh.Link(a=0, b=1)],
    radio=Mesh.Radio(profile="ip"),
)


def until(what, limit_s=40.0):
    began = time.monotonic()
    while not what():
        assert time.monotonic() - began < limit_s, "it did not happen in time"
        time.sleep(0.01)


def test_a_skin_is_brought_up_looked_at_harmed_and_ended():
    with innervate.live_up(SKIN) as nodes:
        assert nodes.names == ["c0", "c1", "pc"]
        assert ("c0", "c1") in nodes.cables
        pids = [one.pid for one in nodes._network.processes.values()]
        until(lambda: nodes.played == ["0.1 s: cut c0 - pc"])
        nodes.restore("pc", "c0")
        until(lambda: nodes.status()["c1"]["parent"] is not None)
        assert "to the PC: by port" in nodes._repr_html_()
        nodes.kill("c1")
        assert sorted(nodes.status()) == ["c0", "pc"]
        assert repr(nodes) == "Nodes(3 of 'skin', 2 running)"
        nodes.start("c1")
        assert sorted(nodes.status()) == ["c0", "c1", "pc"]
        with pytest.raises(innervate.LiveError, match="no cable joins c1 and pc"):
            nodes.cut("c1", "pc")
        with pytest.raises(innervate.LiveError, match="no node is called 'c7'; they are c0, c1"):
            nodes.kill("c7")
    assert repr(nodes) == "Nodes(3 of 'skin', ended)"
    assert not nodes.folder.exists()
    for pid in pids:
        with pytest.raises(ProcessLookupError):
            os.kill(pid, 0)
    with pytest.raises(innervate.LiveError, match="these nodes have been ended"):
        nodes.start("c0")


def test_messages_are_sent(tmp_path):
    with innervate.live_up(PAIR, folder=tmp_path, keys="key") as nodes:
        until(lambda: all(told["table"] for told in nodes.status().values()))
        assert nodes.send("n1", 0, b"here") == "delivered"
        assert nodes.send("n1", 255, b"all") == "accepted", "nobody acknowledges it"
        with pytest.raises(TypeError, match="send takes no reliabel; it takes reliable, priority"):
            nodes.send("n1", 0, b"here", reliabel=False)
        with pytest.raises(TypeError, match="a payload is bytes, not str"):
            nodes.send("n1", 0, "here")
    assert (tmp_path / "n1.log").exists()


def test_what_cannot_be_brought_up_leaves_nothing_running(tmp_path):
    with innervate.live_up(SKIN, folder=tmp_path) as nodes:
        with pytest.raises(innervate.LiveError, match="of another network runs here"):
            innervate.live_up(SKIN, folder=tmp_path)
        assert len(nodes.status()) == 3


@pytest.mark.parametrize("way", [{"cables": "usb"}, {"keys": "kee"}, {"keys": None}])
def test_a_way_that_is_none_is_refused_and_not_taken_for_another(way, tmp_path):
    with pytest.raises(innervate.LiveError, match=r"(cables|keys) must be one of .*, not"):
        innervate.live_up(SKIN, folder=tmp_path, **way)
    assert list(tmp_path.iterdir()) == [], "no node was started, in the clear or otherwise"


def test_a_file_is_no_folder_for_nodes(tmp_path):
    (tmp_path / "run").write_text("")
    with pytest.raises(innervate.LiveError, match="run is a file; name another --folder"):
        innervate.live_up(SKIN, folder=tmp_path / "run")
    with pytest.raises(innervate.LiveError, match="cannot be made: Not a directory"):
        innervate.live_up(SKIN, folder=tmp_path / "run" / "of")


def changing(told):
    """A line's processes that were not started; their nodes note what they are asked."""
    made = up.Processes(scenarios.plan(scenarios.load("line")), Path("unused"), "udp")

    async def note(number, cable, what, loss):
        await asyncio.sleep(0)  # others go on, as while a node is asked
        told.append((number, what))

    made._change_end = note
    return made


def test_of_two_changes_of_a_cable_both_its_ends_hear_the_same_last():
    """One of the scenario's own, as it is played, and one of the program's."""
    told = []
    network = changing(told)

    async def main():
        await asyncio.gather(network.change(0, "cut"), network.change(0, "restore"))

    asyncio.run(main())
    assert told == [(n, what) for what in ("cut", "restore") for n in network.links[0]]


def test_a_node_that_begins_hears_of_a_change_that_comes_meanwhile():
    told = []
    network = changing(told)
    one, other = network.links[0]
    name = network.names[one]
    network.start_node = lambda name: None

    async def at_once(names):
        assert names == [name]

    network._ready = at_once

    async def main():
        await network.change(0, "cut")
        network.processes[name] = SimpleNamespace(poll=lambda: 0)
        await asyncio.gather(network.begin_node(name), network.change(0, "restore"))

    asyncio.run(main())
    assert [what for number, what in told if number == other] == ["cut", "restore"]
    assert [what for number, what in told if number == one][-1] == "restore"
