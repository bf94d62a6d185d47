"""What breaks in a folder's protocol is told by file and line, compiled or plain."""

import re

import pytest

import innervate
from innervate.cli import main
from innervate.live.declared import DeclaredStack
from innervate.network import NetworkError, use
from innervate.running import blaming
from tests.own import alone, own

__all__ = ["alone", "own"]
TAKE = "    node.value = frame.value\n"
SAY = "    frame.value = node.value\n"
BROKEN = {
    "no such field": (TAKE, "    node.valu = frame.value\n", "node.valu =",
                      'did you mean "value"?'),
    "another's": (TAKE, "    node.value = frame.beat_us\n", "frame.beat", "has no attribute"),
    "out of range": (TAKE, "    node.value = frame.value * 100\n", "* 100",
                     "value is 700, declared 0 to 255. invariant broken at 0.1"),
    "a frame out of range": (SAY, "    frame.value = node.value + 256\n", "+ 256",
                             "value of a frame that on_timer sends is 256, declared 0 to 255. inv"),
    "a frame's field that is not set": (SAY, "", "[send(", "value of a frame that on_timer sends "
                                        "is not set: it would be what an earlier frame had there"),
    "a kind without a layout": ("= NEWS\n", "= node.number & 2\n", "number & 2",
                                "kind of a frame that on_timer sends is 0, which has no layout"),
    "when what is delivered was made": ("fill(out.frame[deliver(out, NEWS)], node)",
                                        "out.frame[deliver(out, NEWS)].value = 3", "[deliver(",
                                        "made_at of a frame that on_frame delivers is not set"),
    "division": (TAKE, "    node.value = frame.value // (node.number - node.number)\n", "//",
                 "ZeroDivisionError"),
}  # fmt: skip


@pytest.mark.parametrize("wrong", BROKEN)
def test_a_compiled_run_says_where(own, wrong, capsys):
    old, new, where, words = BROKEN[wrong]
    own.change("protocol.py", old, new)
    assert main(["run", str(own.scenario)]) == 2
    (line,) = capsys.readouterr().err.strip().splitlines()[-1:]
    place = f"gossip/protocol.py:{own.line('protocol.py', where)}: "
    assert place in line
    assert words in line


def test_an_outbox_that_overflows(own):
    own.change("protocol.py", "OUTBOX = 8", "OUTBOX = 4")
    at = own.line("protocol.py", "def on_input") - 3  # the last action of on_timer
    words = rf"protocol.py:{at}: more actions than the outbox holds"
    with pytest.raises(NetworkError, match=words):
        innervate.run(own.scenario)


def test_a_timer_that_is_always_due_at_once_is_told_with_its_line(own):
    own.change("protocol.py", "        tell(node, p, out)\n    set_timer(out, BEAT, "
               "(now + params.beat_us) & MASK30)", "        tell(node, p, out)\n"
               "    set_timer(out, BEAT, now)")  # fmt: skip
    at = own.line("protocol.py", "BEAT, now)")
    says = f"protocol.py:{at}: on_timer sets a timer that is due at once, again and again: time "
    with pytest.raises(NetworkError, match=says):
        innervate.run(own.scenario, plain=True)


def test_timers_for_now_are_few_at_one_time_and_as_many_as_they_want_at_others(own):
    own.change("protocol.py", "    set_timer(out, BEAT, (now + params.beat_us) & MASK30)\n\n\n"
               "def on_frame", "    node.left = 980\n    set_timer(out, BEAT, now)\n\n\n"
               "def on_frame")  # fmt: skip
    own.change("protocol.py", "    for p in range(PORTS):\n        tell(node, p, out)\n"
               "    set_timer(", "    if node.left:\n        node.left -= 1\n"
               "        set_timer(out, BEAT, (now - 3) & MASK30)\n        return\n"
               "    node.left = 1\n    set_timer(")  # fmt: skip
    own.change("fields.py", "STATE = (", 'STATE = (\n    ("left", 0, 0, 980, "calls", "at once"),')
    (case,) = innervate.explore(own.folder, graph="pair", states=300)
    assert case.record["past"] == [["on_timer", 0, 3]]
    assert "; on_timer sets timer 0 up to 3 us in the past, it is due at once" in case.lines[0]
    run = innervate.run(own.scenario, plain=True)
    assert [node.left for node in run.nodes] == [1] * 6


def test_an_index_below_0_is_found_before_it_is_compiled(own):
    own.change("fields.py", '("value", 0, 0, 255, "raw", "what it says"),',
               '("value", 0, 0, 255, "raw", "what it says"),\n'
               '    ("seen", 4, 0, 1, "flag", "by port"),')  # fmt: skip
    own.change("protocol.py", TAKE, TAKE + "        node.seen[port - 4] = 1\n")
    text = (own.folder / "protocol.py").read_text()
    assert "node.seen[port - 4]" in text
    with pytest.raises(NetworkError, match=r"protocol.py:\d+: IndexError: seen\[-\d\]: an index"):
        innervate.run(own.scenario)
    (case,) = innervate.explore(str(own.folder), graph="pair", budget="loss=0,restart=0")
    assert case.is_broken  # compiled and in C [-1] is the memory in front: nobody takes it for more
    assert re.search(r"IndexError: \[-\d\]: an index is 0 to 3", case.lines[-1])
    stack = DeclaredStack(use(own.folder), 1, {"beat_us": 10_000}, 1, [0])
    stack.inbox.kind = stack.inbox.version = 1
    with pytest.raises(IndexError, match=r"\[-4\]: an index is 0 to 3"):
        stack.on_frame(0, 0)


def test_an_own_invariant_that_breaks(own):
    own.change(
        "protocol.py", "    node.version = 0\n", "    node.version = 0\n    node.value = 3\n"
    )
    own.change("protocol.py", "    node.value = 0\n", "")
    with pytest.raises(NetworkError, match="a node without news has a value: n"):
        innervate.run(own.scenario, plain=True)


@pytest.mark.slow  # compiles a protocol that no other test runs
def test_what_breaks_later_than_the_trial_is_found_by_a_second_run(own, monkeypatch):
    monkeypatch.setattr(blaming, "TRIAL_EVENTS", 1)
    own.change("protocol.py", TAKE, "    node.value = frame.value * 100\n")
    at = own.line("protocol.py", "* 100")
    with pytest.raises(NetworkError, match=re.escape(f"protocol.py:{at}: value is 700")):
        innervate.run(own.scenario)


@pytest.mark.slow  # compiles a protocol that no other test runs
def test_a_loop_that_does_not_end_is_stopped_in_a_compiled_run(own, monkeypatch):
    """It ends after 3,000,007 rounds: a run in which nothing stops it is seen to go on."""
    monkeypatch.setattr(blaming, "try_plain", lambda *_given, **_kept: None)
    own.change("protocol.py", TAKE, f"{TAKE}        left = 3_000_000 + node.value\n"
               "        while left > 0:\n            left -= 1\n")  # fmt: skip
    at = own.line("protocol.py", "while")
    with pytest.raises(NetworkError, match=f"protocol.py:{at}: EndlessLoop: a loop of more than 1"):
        innervate.run(own.scenario)


@pytest.mark.slow  # compiles a protocol that no other test runs
def test_an_edit_is_compiled_anew_and_what_was_compiled_stays(own):
    first = innervate.run(own.scenario)
    assert first.result.fingerprint == innervate.run(own.scenario, plain=True).result.fingerprint
    own.change("protocol.py", "    node.value = item.value\n", "    node.value = item.value + 1\n")
    second = innervate.run(own.scenario)
    assert set(second.result.world.cells["value"].tolist()) == {10}
    own.change("protocol.py", "    node.value = item.value + 1\n", "    node.value = item.value\n")
    again = innervate.run(own.scenario)
    assert again.result.fingerprint == first.result.fingerprint


def test_over_cables_a_field_called_as_one_of_the_air_is_as_any_other(own):
    own.change("fields.py", '("version", 0, 0, 65535, "number", "of the news',
               '("to", 0, 0, 7, "node", ""),\n    ("slots", 0, 0, 7, "places", ""),\n'
               '    ("version", 0, 0, 65535, "number", "of the news')  # fmt: skip
    own.change("frames.py", '0, 8, 0))),)', '0, 8, 0))), (2, "for", '
               '(("to", 0, 3, 0), ("slots", 0, 3, 0))))')  # fmt: skip
    innervate.run(own.scenario, plain=True)
    assert not any(case.is_broken for case in innervate.explore(own.folder, states=50))
