"""`innervate prove`: what it prints and returns."""

import json
import os
import re
import signal
import subprocess
import sys
import threading
from dataclasses import replace
from pathlib import Path

import pytest

from innervate.network import networks
from innervate.networks.radio.protocol.constants import WIDE_MOST
from innervate.networks.radio.prove import turns
from innervate.prove import solve
from innervate.prove.steps import Goal, Stage
from tests.own import alone

__all__ = ["alone"]


def test_what_is_proved_is_told_lemma_by_lemma(sh):
    """All that is proved of a radio: its queue, and its turns."""
    assert sh("prove", "radio", "--json") == 0
    *found, missed = json.loads(sh.out)
    assert missed["expected"]
    (story,) = [bad["story"] for bad in missed["steps"][0]["refuted"]]
    assert "B misses the report, and keeps place" in story[2]
    for one in found:
        assert one["expected"]
        assert one["holds"]
        assert one["unreached"] == []
        assert {lemma["answer"] for step in one["steps"] for lemma in step["lemmas"]} == {"unsat"}
        assert sum(len(step["lemmas"]) for step in one["steps"]) == one["lemmas"]
    assert [one["lemmas"] for one in found] == [9, 8 + 2 * (WIDE_MOST + 1), 2]
    assert found[1]["assumed"] == list(turns.ASSUMED)


def test_people_are_told_in_lines(sh, monkeypatch):
    queue = networks()["radio"].prove.theories(networks()["radio"])[0]
    monkeypatch.setattr(networks()["radio"].prove, "theories", lambda _: [queue])
    assert sh("prove", "radio") == 0
    *_, holds, _, last = sh.out.splitlines()
    assert holds == "  Holds: 9 lemmas; 29 ways of branches reached, 3 cannot be, as said."
    assert last.startswith("All as it should be: 9 lemmas in ")


def test_what_the_solver_cannot_say_is_not_said_to_hold(sh, monkeypatch):
    """With hardly any steps to think it finds no state that refutes a lemma."""
    monkeypatch.setattr(solve.Question.__init__, "__defaults__", (50,))
    assert sh("prove", "radio") == 2
    assert "the solver could not say" in sh.err
    assert len(sh.err.splitlines()) == 1
    assert "as it should be" not in sh.out
    assert "Holds" not in sh.out


def test_an_interrupted_proof_says_how_far_it_came(sh, monkeypatch):
    """Ctrl-C comes while the first of some theories is tried."""
    network = networks()["radio"]
    queue, *others = network.prove.theories(network)

    def interrupted():
        os.kill(os.getpid(), signal.SIGINT)
        return step()

    *first, step = queue.steps
    made = replace(queue, steps=(*first, interrupted))
    monkeypatch.setattr(network.prove, "theories", lambda _: [made, *others])
    assert sh("prove", "radio") == 130
    cut = f"; interrupted after 0 of {1 + len(others)} theories."
    assert sh.out.splitlines()[-1].endswith(cut)
    assert "All as it should be" not in sh.out


PRIMES = 2_147_483_659, 2_147_483_693  # whose product the solver takes minutes to take apart


@pytest.fixture
def hard(monkeypatch):
    """Makes a step whose one question takes the solver long, in which Ctrl-C comes."""
    monkeypatch.setattr(solve.Question.__init__, "__defaults__", (20_000_000,))

    def make():
        stage = Stage({}, (), 1)
        a, b = (stage.terms.unknown(name, 2, (1 << 32) - 1) for name in "ab")
        product = stage.terms.same(stage.terms.mul(a, b), stage.number(PRIMES[0] * PRIMES[1]))
        threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT)).start()
        return stage.step("hard", {}, [], [Goal("it is a prime", stage.terms.negated(product))])

    return make


def test_the_solver_is_not_waited_for(sh, monkeypatch, hard):
    """Ctrl-C comes while it thinks; what was found before is told."""
    network = networks()["radio"]
    queue, *others = network.prove.theories(network)
    made = replace(queue, steps=(queue.steps[0], hard))
    monkeypatch.setattr(network.prove, "theories", lambda _: [made, *others])
    assert sh("prove", "radio", "--json") == 130
    (one,) = json.loads(sh.out)
    assert (one["ended"], len(one["steps"]), one["expected"]) == ("stopped", 1, False)


def test_nor_is_it_where_mistakes_are_planted(sh, monkeypatch, hard):
    network = networks()["radio"]
    queue, *_ = network.prove.theories(network)
    monkeypatch.setattr(network.prove, "theories", lambda *_: [replace(queue, steps=(hard,))])
    assert sh("prove", "radio", "--faults") == 130
    assert sh.err.splitlines()[-1].startswith("innervate: interrupted after 0 of ")


def test_planted_mistakes_are_refuted(sh):
    """All of a radio's: of its queue and of turns."""
    assert sh("prove", "radio", "--faults") == 0
    refuted = [re.search(r": ([QR]\d|no |every |places )", line) for line in sh.out.splitlines()]
    assert len(refuted) >= 7
    assert all(refuted)


def test_a_folder_is_named_by_its_path(sh, alone):
    assert sh("prove", str(Path(__file__).parents[2] / "examples" / "aloha")) == 0
    assert sh.out.splitlines()[-1].startswith("All as it should be: 16 lemmas in ")


def test_an_unknown_network_is_named(sh):
    assert sh("prove", "") == sh("verify", "") == 2
    assert sh("prove", "bus") == 2
    assert sh.err == 'innervate: prove knows skin, radio, mesh, babel, flooding or rpl, not "bus"\n'


def test_without_the_solver_it_says_what_to_install():
    hide = "import sys; sys.modules['z3'] = None; from innervate.cli import main; sys.exit(main())"
    told = subprocess.run([sys.executable, "-c", hide, "prove"], capture_output=True, text=True)
    assert told.returncode == 2
    assert "innervate[prove]" in told.stderr
    assert len(told.stderr.splitlines()) == 1
