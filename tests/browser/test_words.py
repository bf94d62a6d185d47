"""The page by its sources: what is said of a node that is not there, what plots show of silence."""

import json
import shutil
import subprocess
from pathlib import Path

import pytest

PAGE = Path(__file__).resolve().parents[2] / "src" / "innervate" / "web" / "page"


def said(networks, call="it.off(network, 0)"):
    """What off() says of node 0 of each of these, or what else is called."""
    return found("words.js", f"{json.dumps(networks)}.map((network) => {call})")


def found(file, value):
    """A value in JavaScript where `it` is one of the page's sources."""
    if shutil.which("node") is None:
        pytest.skip("Node.js is missing")
    text = f"""const it = await import({json.dumps((PAGE / file).as_uri())});
    console.log(JSON.stringify({value}));"""
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
    assert said(list(cases.values()), "it.offWords(network)") == list(cases)


@pytest.mark.parametrize(("source", "shown"), [
    ("live", [[[3, 1], [4, 0]], [], [[7, 5]]]), ("simulation", [[[3, 1], [4, 0], [7, 5]]]),
])  # fmt: skip
def test_a_plot_has_a_gap_while_no_live_node_answers(source, shown):
    points = [[1, 9], [2, 8], [3, 1], [4, 0], [5, None], [6, None], [7, 5]]
    assert plotted(source, points, "network.curves('load', 3.5)") == shown


@pytest.mark.parametrize(("times", "source", "span_s"), [
    ([], "simulation", 10), ([3], "simulation", 10), ([3, 3.1, 3.2], "simulation", 10),
    ([0, 200, 400], "simulation", 8000), ([0, 200, 200.1], "simulation", 8000),
    ([0, 200, 200.1, 200.2], "simulation", 10), ([0, 200, 400], "live", 10),
])  # fmt: skip
def test_a_plot_shows_more_time_where_that_goes_fast(times, source, span_s):
    assert plotted(source, [[t, 1] for t in times], "network.span('load')") == span_s


def plotted(source, points, call):
    """What a network says of its plot of these points."""
    scene = {"kind": "mesh", "source": source, "nodes": [], "links": [], "can": [],
             "series": [{"id": "load"}]}  # fmt: skip
    return found(
        "network.js",
        f"""(() => {{
      const network = new it.Network({json.dumps(scene)});
      network.apply({{ series: {{ load: {json.dumps(points)} }} }});
      return {call};
    }})()""",
    )
