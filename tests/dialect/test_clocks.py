"""Readings of a clock that are compared as what they are not."""

import pytest

from innervate.dialect.clocks import of_clocks

TABLES = (
    ("due", 0, 0, 1_073_741_823, "us", "when"),
    ("seen", 4, 0, 1_073_741_823, "us", "when, at each port"),
    ("seq", 0, 0, 65_535, "number", "newest"),
    ("age", 0, 0, 65_535, "number", "of a state"),
    ("age", 0, 0, 1_073_741_823, "us", "of a frame: which is meant is not known"),
    ("wait_us", 0, 0, 1_000_000, "us", "how long"),
)


def said(tmp_path, line, arguments="node, params, now, port, frame, out"):
    """Line and text of what is wrong with a function of one line."""
    path = tmp_path / "protocol.py"
    path.write_text(f'"""Doc."""\n\n\ndef on_frame({arguments}):\n    """Doc."""\n    {line}\n')
    return [(one.line, one.text) for one in of_clocks(path, TABLES, {"wait_us"})]


@pytest.mark.parametrize("line", [
    "return now > node.due",
    "return node.seen[port] <= now",
    "return 0 < now < 300_000",
])  # fmt: skip
def test_now_is_not_compared_by_its_size(tmp_path, line):
    ((at, text),) = said(tmp_path, line)
    assert at == 6
    assert "now goes round at 2^30 and begins anywhere; write after(a, b)" in text


@pytest.mark.parametrize("line", [
    "return now - node.due > params.wait_us",
    "return params.wait_us >= node.due - now",
])  # fmt: skip
def test_a_difference_goes_round_too(tmp_path, line):
    ((_, text),) = said(tmp_path, line)
    assert "is below 0 when the clock goes round; write (" in text
    assert text.endswith(") & MASK30")


@pytest.mark.parametrize(("line", "name"), [
    ("return later(node.due, now)", "due"),
    ("return later(node.seen[port], node.seq)", "seen"),
    ("return not later(now, node.seq)", "now"),
    ("return arith.later(node.due, node.seq)", "due"),
])  # fmt: skip
def test_later_is_not_for_readings(tmp_path, line, name):
    ((_, text),) = said(tmp_path, line)
    assert f"later is for sequence numbers of 16 bits, and {name} is up to 1073741823" in text


@pytest.mark.parametrize("line", [
    "return after(now, node.due)",
    "return later(frame.seq, node.seq)",
    "return later(frame.seq, port)",
    "return later(node.age, node.seq)",
    "return ((now - node.due) & MASK30) > params.wait_us",
    "return now != node.due and params.wait_us < port",
    "return (now + params.wait_us) & MASK30",
])  # fmt: skip
def test_what_is_right_is_let_be(tmp_path, line):
    assert said(tmp_path, line) == []


def test_a_number_of_ones_own_may_be_called_now(tmp_path):
    assert said(tmp_path, "return now < 0", arguments="now_cm, before") == []
    now = "now = node.seq\n    return now < 3"
    assert said(tmp_path, now, arguments="node") == []


@pytest.mark.parametrize(("line", "wait"), [
    ("set_timer(out, BEAT, params.wait_us)", "params.wait_us"),
    ("set_timer(out, BEAT, 5000 & MASK30)", "5000 & MASK30"),
    ("outbox.set_timer(out, BEAT, params.wait_us // 2)", "params.wait_us // 2"),
    ("set_timer(out, BEAT, min(params.wait_us, draw(node, 8)))",
     "min(params.wait_us, draw(node, 8))"),
    ("wait = params.wait_us\n    wait += sizes.MORE\n    set_timer(out, BEAT, wait)", "wait"),
    ("set_timer(out, BEAT, time_left(node.due, now))", "time_left(node.due, now)"),
])  # fmt: skip
def test_a_timer_is_not_set_to_how_long_it_runs(tmp_path, line, wait):
    ((at, text),) = said(tmp_path, line)
    assert at == 6 + line.count("\n")
    assert text == (f"set_timer takes when, a reading of the clock, and {wait} is how long; "
                    f"write (now + {wait}) & MASK30")  # fmt: skip


@pytest.mark.parametrize("line", [
    "set_timer(out, BEAT, (now + params.wait_us) & MASK30)", "set_timer(out, BEAT, now)",
    "set_timer(out, BEAT, node.due)", "set_timer(out, BEAT, port)",
    "at = params.wait_us\n    at += now\n    set_timer(out, BEAT, at)",
    "at = params.wait_us\n    at = at + node.due\n    set_timer(out, BEAT, at)",
    "set_timer(out, BEAT, soon(params.wait_us))", "set_timer(out, BEAT, max(now, 5))",
])  # fmt: skip
def test_a_timer_is_set_to_a_reading(tmp_path, line):
    assert said(tmp_path, line) == []
