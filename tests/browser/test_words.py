"""Words of the page, by its sources: what is said of a node that is not there."""

import json
import shutil
import subprocess
from pathlib import Path

import pytest

WORDS = Path(__file__).resolve().parents[2] / "src" / "innervate" / "web" / "page" / "words.js"


def said(networks, call="off(network, 0)"):
    """What off() says of node 0 of each of these, or what else is called."""
    if shutil.which("node") is None:
        pytest.skip("Node.js is missing")
    text = f"""const {{ off, offWords }} = await import({json.dumps(WORDS.as_uri())});
    console.log(JSON.stringify({json.dumps(networks)}.map((network) => {call})));"""
    done = subprocess.run(
        ["node", "--input-type=module", "-e", text], capture_output=True, check=True, timeout=60
    )
    return json.loads(done.stdout)


def test_who_is_yet_to_come_is_not_called_switched_off():
    def network(kind, source="simulation", **now):
        return {"kind": kind, "scene": {"source": source}, "now": now}

    cases = {
        "not in the team": network("radio", absent=[1]),
        "yet to come": network("mesh", absent=[1]),
        "not there": network("own", absent=[1]),
        "switched off": network("mesh", absent=[0]),
        "switched off ": network("skin"),
        "cut off": network("radio", "live", cut_off=[1]),
        "does not answer": network("radio", "live", cut_off=[0]),
    }
    assert said(list(cases.values())) == [words.strip() for words in cases]


def test_legends_say_of_one_sign_all_that_it_means():
    def network(kind, **scene):
        return {"kind": kind, "scene": {"source": "simulation", **scene}}

    cases = {
        "switched off, or not in the team": network("radio", absent=True),
        "switched off, or yet to come": network("mesh", absent=True),
        "switched off, or not there": network("own", absent=True),
        "switched off": network("mesh"),
        "cut off, or silent": network("radio", source="live"),
    }
    assert said(list(cases.values()), "offWords(network)") == list(cases)
