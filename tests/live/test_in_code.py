"""live_up(scenario): a scenario's nodes as processes, held by a program."""

import os
import time

import pytest

import innervate
from innervate import Mesh, Skin

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
