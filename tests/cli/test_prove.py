"""`innervate prove`: what it prints and returns."""

import json
import subprocess
import sys


def test_a_skin_is_proved(sh):
    assert sh("prove", "--json") == 0
    found = json.loads(sh.out)
    assert all(theory["expected"] for theory in found)
    feasible = next(one for one in found if one["theory"] == "skin, rule feasible")
    assert feasible["holds"]
    assert len(feasible["assumed"]) > 3
    assert {lemma["answer"] for step in feasible["steps"] for lemma in step["lemmas"]} == {"unsat"}


def test_an_unknown_network_is_named(sh):
    assert sh("prove", "bus") == 2
    assert sh.err == 'innervate: prove knows skin, radio or mesh, not "bus"\n'


def test_without_the_solver_it_says_what_to_install():
    hide = "import sys; sys.modules['z3'] = None; from innervate.cli import main; sys.exit(main())"
    told = subprocess.run([sys.executable, "-c", hide, "prove"], capture_output=True, text=True)
    assert told.returncode == 2
    assert "innervate[prove]" in told.stderr
    assert len(told.stderr.splitlines()) == 1
