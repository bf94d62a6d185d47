"""Commands that speak with running nodes, against sockets that answer what is written here."""

import json
import socket
import threading

import pytest

from innervate.cli import live, live_enrol
from innervate.cli.errors import UserError
from innervate.cli.options import SendOptions
from innervate.live.enrolment import LIST, Authority, read_list
from innervate.live.errors import LiveError


class Node:
    """A socket in the folder of running nodes; answers each request with the next lines."""

    def __init__(self, folder, name, *answers):
        self.asked, self.answers = [], list(answers)
        self.sock = socket.socket(socket.AF_UNIX)
        self.sock.bind(str(folder / f"{name}.sock"))
        self.sock.listen()
        threading.Thread(target=self._serve, daemon=True).start()

    def _serve(self):
        for lines in self.answers:
            connection, _ = self.sock.accept()
            with connection, connection.makefile("rb") as file:
                self.asked.append(json.loads(file.readline()))
                connection.sendall("".join(json.dumps(one) + "\n" for one in lines).encode())
        self.sock.close()


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.setenv("INNERVATE_RUN", str(tmp_path / "run"))
    monkeypatch.chdir(tmp_path)
    (tmp_path / "run").mkdir(mode=0o700)
    return tmp_path / "run"


def test_who_is_put_out_is_told_to_all_and_told_again_later(folder, tmp_path, capsys):
    keys, node = tmp_path / "keys", Node(folder, "n1", [{"version": 1}], [{"version": 1}])
    assert live_enrol.enrol(keys, 7, nodes=2) == 0
    said = capsys.readouterr()
    assert said.out.split() == [str(keys / f"n{i}.identity") for i in (0, 1, 7)]
    assert said.err == (
        f"innervate: {keys} has a new authority; nodes that another one enrolled do not know its "
        "nodes\n"
    )
    assert live_enrol.enrol(keys, 8) == 0
    assert capsys.readouterr() == (f"{keys / 'n8.identity'}\n", "")
    with pytest.raises(UserError, match="nobody is put out"):
        live_enrol.revoke(keys)
    assert live_enrol.revoke(keys, 7) == 0
    assert capsys.readouterr().out == "told n1; nodes hand it on to each other\n"
    (_, serial) = next(one for one in Authority(keys).issued if one[0] == 7)
    assert (Authority(keys).revoked, Authority(keys).version) == ({serial}, 1)
    assert live_enrol.revoke(keys, as_json=True) == 0
    assert json.loads(capsys.readouterr().out) == {"told": [{"node": "n1", "version": 1}],
                                                  "not": []}  # fmt: skip
    assert Authority(keys).version == 1
    said = {"do": "revoke", "list": read_list(keys / LIST).hex()}
    assert node.asked == [said, said]


def test_a_list_alone_is_handed_on_and_puts_nobody_out(folder, tmp_path, capsys):
    keys = tmp_path / "keys"
    Authority(keys).enrol(3)
    Authority(keys).revoke([3])
    one, other = Node(folder, "n1", [{"error": "no"}]), Node(folder, "n10", [{"version": 1}])
    assert live_enrol.revoke(keys / LIST, as_json=True) == 0
    told = json.loads(capsys.readouterr().out)
    assert (told["told"], told["not"]) == ([{"node": "n10", "version": 1}], ["n1: no"])
    assert one.asked == other.asked == [{"do": "revoke", "list": read_list(keys / LIST).hex()}]
    with pytest.raises(UserError, match="no folder of an authority"):
        live_enrol.revoke(keys / LIST, 3)


def test_where_no_node_is_told_it_is_said_what_to_do_there(folder, tmp_path, capsys):
    Authority(tmp_path / "keys").enrol(3)
    assert live_enrol.revoke(tmp_path / "keys", 3) == 1
    assert capsys.readouterr().out == (
        f"told nobody: no node runs here that takes it; copy {tmp_path / 'keys' / LIST} to a "
        f"machine where one runs, and there: innervate live revoke {LIST}\n"
    )
    assert live_enrol.revoke(tmp_path / "keys" / LIST) == 1
    assert f"copy {tmp_path / 'keys' / LIST} to" in capsys.readouterr().out
    with pytest.raises(UserError, match="which nodes"):
        live_enrol.enrol(tmp_path / "keys")


STATUS = {"name": "n1", "kind": "mesh"}


@pytest.fixture
def plain(monkeypatch):
    """What is said of nodes in short: tests of their words are elsewhere."""
    monkeypatch.setattr(live.live_status, "lines", lambda one: [f"{one['name']} is well"])
    monkeypatch.setattr(
        live.live_status, "headline", lambda told, silent: f"{len(told)} {len(silent)}"
    )
    monkeypatch.setattr(live.live_status, "broken", lambda told: [f"broken of {len(told)}"])


def test_the_status_of_all_has_a_headline_and_that_of_one_has_none(folder, plain, capsys):
    with pytest.raises(UserError, match="no node runs here"):
        live.show()
    first, second = {"name": "n1"}, {"name": "n2"}
    asked = [Node(folder, "n1", *[[first]] * 4), Node(folder, "n2", *[[second]] * 2)]
    assert live.show() == 0
    assert capsys.readouterr().out.splitlines() == [
        "2 0", "n1 is well", "n2 is well", "broken of 2"]  # fmt: skip
    assert live.show("n1") == 0
    assert capsys.readouterr().out.splitlines() == ["n1 is well", "broken of 1"]
    assert live.show(as_json=True) == live.show("n1", as_json=True) == 0
    every, one = map(json.loads, capsys.readouterr().out.splitlines())
    assert (every, one) == ([first, second], first)
    assert asked[0].asked == [{"do": "status"}] * 4


def test_who_does_not_answer_is_named_unless_it_was_asked_for(folder, plain, capsys):
    Node(folder, "n1", [STATUS])
    Node(folder, "n2", [], [])  # closes without a word
    assert live.show() == 1
    said = capsys.readouterr()
    assert said.out.splitlines()[0] == "1 1"
    assert said.err == "n2: does not answer; its process was killed, or hangs\n"
    with pytest.raises(LiveError, match="the node went away"):
        live.show("n2")
    with pytest.raises(LiveError, match='no node "n3" runs here; running: n1, n2 '):
        live.show("n3")


@pytest.mark.parametrize(("to", "reliable", "states", "code", "shown"), [
    (3, True, ["accepted", "sent", "delivered"], 0, ["accepted", "sent", "delivered"]),
    (3, True, ["accepted", "expired", "delivered"], 1, ["accepted", "expired"]),
    (3, True, ["refused"], 1, ["refused"]), (3, True, ["accepted"], 1, ["accepted"]),
    (3, False, ["accepted", "delivered"], 0, ["accepted"]),
    (255, True, ["accepted", "delivered"], 0, ["accepted"]), (3, True, [], 1, []),
])  # fmt: skip
def test_a_message_is_followed_to_its_end(folder, capsys, to, reliable, states, code, shown):
    answers = [{"state": state, "reason": ""} for state in states]
    node = Node(folder, "n1", answers, answers)
    how = SendOptions(reliable=reliable)
    assert live.send("n1", to, "hi", how=how) == code
    assert capsys.readouterr().out.split() == shown
    assert live.send("n1", to, "hi", how=how, as_json=True) == code
    printed = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    assert printed == answers[: len(shown)]
    wait = reliable and to != 255
    asked = {"do": "send", "to": to, "payload": "6869", **how.asked, "wait": wait}
    assert node.asked == [asked, asked]


def test_a_reason_is_said_behind_the_state(folder, capsys):
    Node(folder, "n1", [{"state": "refused", "reason": "too long"}])
    assert live.send("n1", 3, "hi") == 1
    assert capsys.readouterr().out == "refused: too long\n"


@pytest.mark.parametrize("in_order", [False, True])
def test_as_many_messages_are_heard_as_were_asked_for(folder, capsys, in_order):
    heard = [{"missed": 2}, {"from": 3, "text": "a"}, {"other": 1}, {"from": 4, "text": "b"}]
    node = Node(folder, "n1", [STATUS], heard, [STATUS], heard)
    assert live.listen("n1", count=1, in_order=in_order, as_json=True) == 0
    said = capsys.readouterr()
    assert json.loads(said.out) == heard[1]
    assert said.err == "2 missed here: they were not read in time\n"
    assert live.listen("n1", in_order=in_order, as_json=True) == 0
    assert [json.loads(line)["from"] for line in capsys.readouterr().out.splitlines()] == [3, 4]
    asked = {"do": "listen", "alarms": True} | ({"in_order": True} if in_order else {})
    assert node.asked == [{"do": "status"}, asked] * 2


@pytest.mark.parametrize(("cell", "ports", "said"), [
    (None, 1, "command 9 to all cells, by 1 interface port\n"),
    (4, 2, "command 9 to cell 4, by 2 interface ports\n"),
    (0, 2, "command 9 to cell 0, by 2 interface ports\n"), (4, 0, ""),
])  # fmt: skip
def test_a_command_goes_down_by_as_many_ports_as_there_are(folder, capsys, cell, ports, said):
    answer = {"number": 9, "ports": ports}
    node = Node(folder, "pc", [answer], [answer])
    assert (
        live.command("pc", 5, 6, cell=cell)
        == live.command("pc", 5, 6, cell=cell, as_json=True)
        == (0 if ports else 1)
    )
    shown = capsys.readouterr()
    assert shown.out == said + json.dumps(answer) + "\n"
    assert ("nobody is there to hand it down" in shown.err) == (not ports)
    assert node.asked == [{"do": "command", "code": 5, "value": 6, "cell": cell}] * 2


@pytest.mark.parametrize("checked", [False, True])
def test_of_a_cell_that_may_not_be_there_is_said_so(folder, capsys, checked):
    Node(folder, "pc", [{"number": 9, "ports": 1, "checked": checked}])
    assert live.command("pc", 5, 6, cell=900) == 0
    shown = capsys.readouterr()
    assert shown.out == "command 9 to cell 900, by 1 interface port\n"
    assert ("nobody knows whether there is a cell 900" in shown.err) == (not checked)


@pytest.mark.parametrize("what", ["cut", "restore"])
def test_a_cable_is_cut_and_restored_at_one_node(folder, what):
    node = Node(folder, "n1", [{"ok": True}])
    assert live.change("n1", 2, restore=what == "restore") == 0
    assert node.asked == [{"do": what, "port": 2}]


def test_what_cannot_be_counted_or_read_is_said_before_a_node_is_asked(folder, monkeypatch):
    node = Node(folder, "n1", [STATUS])
    with pytest.raises(UserError, match="--count must be a whole number from 0, not -1"):
        live.listen("n1", count=-1)
    monkeypatch.setattr("sys.stdin", None)  # as Python has it where it was closed
    with pytest.raises(UserError, match="- reads standard input, which is closed"):
        live.send("n1", 3, "-")
    assert node.asked == []


def test_a_message_need_not_be_text(folder):
    node = Node(folder, "n1", [{"state": "delivered", "reason": ""}])
    assert live.send("n1", 3, "\udcff") == 0
    assert node.asked[0]["payload"] == "ff"
