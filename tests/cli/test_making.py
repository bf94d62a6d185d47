"""`innervate new network` and `check-protocol`."""

import json

from innervate.cli import main
from tests.own import alone, own

__all__ = ["alone", "own"]


def checked(capsys, *words):
    code = main(["check-protocol", "gossip", *words])
    return code, capsys.readouterr().out


def test_what_no_test_reaches_is_named(own, capsys):
    test = own.folder / "test_gossip.py"
    test.write_text('"""Tests."""\n\n\ndef test_nothing():\n    assert True\n')
    code, said = checked(capsys, "--json")
    assert code == 0
    told = json.loads(said)
    assert set(told["unreached"]) == {
        "on_start", "on_frame", "on_timer", "on_input", "is_newer", "tell", "fill",
    }  # fmt: skip
    assert (
        told["unreached"]["on_frame"] == f"gossip/protocol.py:{own.line('protocol.py', 'on_frame')}"
    )
    assert told["outbox"] == {"on_start": 1, "on_frame": 5, "on_timer": 5, "on_input": 4}
    test.write_text('"""Tests."""\n\n\ndef test_nothing():\n    assert False\n')
    code, said = checked(capsys)
    assert code == 1
    assert "gossip: FAILED" in said


def test_an_outbox_that_is_too_small_and_loops_that_are_not_counted(own, capsys):
    own.change("protocol.py", "OUTBOX = 8", "OUTBOX = 4")
    own.change("protocol.py", "        for p in range(PORTS):\n            if p != port:",
               "        for p in range(node.number):\n            if p != port:")  # fmt: skip
    code, said = checked(capsys, "--no-tests")
    at = own.line("protocol.py", "def on_timer")
    assert f"gossip/protocol.py:{at}: on_timer may put 5 actions, the outbox holds 4" in said
    at = own.line("protocol.py", "range(node.number)")
    assert f"gossip/protocol.py:{at}: on_frame: how many actions it may put is not seen" in said
    assert "So: an outbox overflowed" in said
    assert code == 1


def test_every_mistake_is_told_at_once(own, capsys):
    own.change("protocol.py", "NEWS = 1", "NEWS = 1.5")
    own.change("protocol.py", "    node.value = item.value\n", "    node.value = [item.value]\n")
    code, said = checked(capsys)
    assert code == 2
    first, second = said.splitlines()
    assert first.startswith(f"gossip/protocol.py:{own.line('protocol.py', '1.5')}: a float")
    assert "declare a field with a length" in second
