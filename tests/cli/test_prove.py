"""`innervate prove`: what it prints and returns."""

import json
import re
import subprocess
import sys


def test_what_is_proved_is_told_lemma_by_lemma(sh):
    assert sh("prove", "radio", "--json") == 0
    queue, turns = json.loads(sh.out)
    for found in (queue, turns):
        assert found["expected"]
        assert found["holds"]
        assert {lemma["answer"] for step in found["steps"] for lemma in step["lemmas"]} == {"unsat"}
        assert sum(len(step["lemmas"]) for step in found["steps"]) == found["lemmas"]
    assert (queue["lemmas"], turns["lemmas"]) == (7, 15)
    assert sh("prove", "radio") == 0
    assert sh.out.splitlines()[-1].startswith("All as it should be: 22 lemmas in ")


def test_planted_mistakes_are_refuted(sh):
    assert sh("prove", "radio", "--faults") == 0
    refuted = [re.search(r": ([QR]\d|no |every )", line) for line in sh.out.splitlines()]
    assert len(refuted) >= 7
    assert all(refuted)


def test_an_unknown_network_is_named(sh):
    assert sh("prove", "bus") == 2
    assert sh.err == 'innervate: prove knows skin, radio or mesh, not "bus"\n'


def test_without_the_solver_it_says_what_to_install():
    hide = "import sys; sys.modules['z3'] = None; from innervate.cli import main; sys.exit(main())"
    told = subprocess.run([sys.executable, "-c", hide, "prove"], capture_output=True, text=True)
    assert told.returncode == 2
    assert "innervate[prove]" in told.stderr
    assert len(told.stderr.splitlines()) == 1
