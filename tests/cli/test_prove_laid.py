"""What a proof says of a folder besides ranges: kinds without layouts, a generator written to."""

import json

import pytest

from tests.own import Own, alone, own

__all__ = ["alone", "own"]


def refuted(sh, own):
    """(exit code, what JSON says holds, names of what does not)."""
    code = sh("prove", str(own.folder), "--json")
    (found,) = json.loads(sh.out)
    return code, found["holds"], {bad["lemma"] for s in found["steps"] for bad in s["refuted"]}


def test_a_kind_that_is_sent_at_some_values_only_needs_a_layout(sh, own):
    own.change("protocol.py", "frame.kind = NEWS", "frame.kind = NEWS + (node.value > 100)")
    name = "every kind of frame that tell sends has a layout"
    assert refuted(sh, own) == (1, False, {name})
    assert sh("prove", str(own.folder)) == 1
    assert "Does NOT hold." in sh.out
    assert sh.out.splitlines()[-1].startswith("NOT as it should be: gossip")
    own.change("frames.py", "),)", "), (2, 'old', (('version', 0, 16, 0), ('value', 0, 8, 0))))")
    assert refuted(sh, own) == (0, True, set())


@pytest.mark.parametrize(("asks", "lemmas"), [
    ("frame.kind == 3", {"kind 3, which on_frame asks for, has a layout"}),
    ("frame.kind != NEWS", set()),
    ("node.version == 3", set()),
])  # fmt: skip
def test_a_kind_that_is_asked_for_needs_a_layout(sh, own, asks, lemmas):
    first = "    if is_newer(frame.version, node.version):\n"
    own.change("protocol.py", first, f"    if {asks}:\n        return\n{first}")
    assert refuted(sh, own) == (1 if lemmas else 0, not lemmas, lemmas)


@pytest.mark.parametrize(("writes", "field"), [("choice = 5", "choice"), ("rng = 0", "rng")])
def test_what_draws_live_on_is_written_by_draws_alone(sh, alone, writes, field):
    own = Own(alone / "talk")
    sh("new", "network", str(own.folder), "--on", "channel")
    last = "    set_timer(out"
    path = own.folder / "protocol.py"
    text = path.read_text()
    assert refuted(sh, own) == (0, True, set())
    path.write_text(text.replace(last, f"    node.{writes}\n{last}", 1))
    lemma = f"{field} is written by draws alone, which stand for any number"
    assert refuted(sh, own) == (1, False, {lemma})
