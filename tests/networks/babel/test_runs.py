"""Babel runs: compiled and plain alike, mends itself, lives between processes, on boards, as C."""

import shutil

import pytest

import innervate
from innervate import scenario as scenarios
from innervate.cli import main
from innervate.networks.babel.protocol.fields import DEFAULTS
from innervate.running.simulating import simulate

HELLO_MS = DEFAULTS["hello_us"] / 1e3
GRID = {"kind": "babel", "nodes": 9, "shape": "grid", "duration_s": 0.3, "links": {"loss": 0.02}}
CUT = {"at_s": 0.15, "action": "cut", "link": "n0-n1"}
KILL = {"at_s": 0.2, "action": "kill", "node": 4}
DATA = {"at_s": 0.05, "every_s": 0.01}


def simulated(plain=True, seed=1, **changes):
    plan = scenarios.plan(scenarios.from_dict({**GRID, **changes}, seed=seed))
    return simulate(plan, plain=plain)


def routed(result):
    return [node.parent >= 0 for node in result.world.cells]


@pytest.mark.slow
def test_compiled_and_plain_runs_are_the_same_row_for_row():
    etx = {"etx": 1, "up_least": 1, "up_of": 6, "nominal": 256, "margin": 64}
    for protocol in ({}, etx):
        changes = {"event": [CUT, KILL], "input": [DATA], "protocol": protocol}
        both = [simulated(plain, **changes) for plain in (True, False)]
        assert both[0].fingerprint == both[1].fingerprint
        for name in ("rows", "deliveries"):
            assert both[0].rows[name].tolist() == both[1].rows[name].tolist()
            assert len(both[0].rows[name]) > 20


def test_everybody_finds_a_way_and_another_one():
    before = simulated(duration_s=0.1, links={})
    assert routed(before) == [False] + [True] * 8
    after = simulated(event=[CUT, KILL], links={})
    assert routed(after)[1:4] + routed(after)[5:] == [True] * 7
    assert after.world.cells[1].parent == 1  # n2 is to the east; n4 below is dead
    assert after.world.cells[0].seqno == 2  # twice n1 had no feasible route left


def test_a_part_that_is_cut_off_retracts_and_comes_back():
    cuts = [{"at_s": 0.1, "action": "cut", "link": link} for link in ("n0-n1", "n0-n3")]
    assert not any(routed(simulated(event=cuts, links={})))
    again = {"at_s": 0.2, "action": "restore", "link": "n0-n3"}
    assert routed(simulated(event=[*cuts, again], links={})) == [False] + [True] * 8


def test_a_source_that_restarts_is_found_again():
    restart = {"at_s": 0.15, "action": "restart", "node": 0}
    result = simulated(event=[CUT, {**restart, "at_s": 0.2}], links={})
    assert routed(result) == [False] + [True] * 8
    assert result.world.cells[0].seqno >= 1  # kept, or nobody would believe it


def test_data_comes_hop_by_hop():
    run = innervate.run({**GRID, "links": {}, "input": [DATA]}, plain=True)
    messages = run.summary["messages"]
    assert messages["delivered"] == 8 * 25
    assert run.summary["measures"]["dropped_data"] == 0
    assert 0.1 < messages["latency_ms"]["p50"] < messages["latency_ms"]["max"] < 1


@pytest.mark.parametrize("urgent_us", [1, 100_000])
def test_how_long_an_update_may_wait_that_is_triggered(urgent_us):
    """At least a microsecond, so that all news of a call go out together."""
    plan = scenarios.plan(scenarios.from_dict({**GRID, "protocol": {"urgent_us": urgent_us}}))
    assert plan.params["urgent_us"] == urgent_us
    beyond = 0 if urgent_us == 1 else 100_001
    with pytest.raises(scenarios.ScenarioError, match=f"^urgent_us must be .*, not {beyond}$"):
        scenarios.from_dict({**GRID, "protocol": {"urgent_us": beyond}})


def test_lossy_links_are_gone_round_by_etx():
    # n3 hears n0 over a bad cable, and over two good ones.
    cables = ["n0-n1", "n1-n2", "n2-n3", "n0-n3"]
    loose = {"at_s": 0.1, "action": "loose", "link": "n0-n3", "loss": 0.55}
    etx = {"etx": 1, "up_least": 1, "up_of": 12, "nominal": 256, "margin": 64}

    def share(protocol):
        """Of the time in which n3 goes by the bad cable."""
        tables = {"kind": "babel", "cables": cables, "duration_s": 0.8, "event": [loose]}
        rows = innervate.run({**tables, "protocol": protocol}, plain=True).result.rows["rows"]
        own = rows[(rows["node"] == 3) & (rows["code"] == 1)]
        ends = [*own["time"][1:].tolist(), 800_000]
        told = zip(own["time"].tolist(), own["a"].tolist(), ends, strict=True)
        return sum(end - max(at, 100_000) for at, port, end in told if port == 1) / 700_000

    assert share(etx) < 0.2
    assert share({"up_least": 1}) > 0.4


def test_the_folder_is_checked_as_one_of_your_own(capsys):
    import innervate.networks.babel as home

    (place,) = home.__path__
    assert main(["check-protocol", place, "--no-tests"]) == 0
    said = capsys.readouterr().out
    assert (
        "babel: the dialect is kept, values and frames fit, at most 29 actions a call of 34" in said
    )


@pytest.mark.slow
def test_it_lives_between_processes(tmp_path, capsys):
    tables = ["--set", "nodes=4", "--set", "event=[]", "--set", "input=[]"]
    assert main(["live", "up", "babel-patch", "--for", "2", *tables]) == 0
    assert "4 nodes and 4 cables are up after" in capsys.readouterr().out


@pytest.mark.slow
def test_its_c_does_call_by_call_what_its_python_does():
    from boards.firmware import __main__ as parity
    from boards.roles import roles

    if shutil.which("gcc") is None:
        pytest.skip("gcc is not installed")
    replayed, drawn = parity.compare(roles()["babel"], 2000, 1, sanitized=True)
    assert replayed + drawn == 2000


@pytest.mark.slow
def test_micropython_does_call_by_call_what_its_python_does(capsys):
    from boards.errors import BoardMissing
    from boards.parity import __main__ as parity
    from boards.parity import nodejs

    try:
        nodejs.home()
    except BoardMissing as missing:
        pytest.skip(str(missing))
    assert parity.main(["babel"]) == 0
    assert "all the same" in capsys.readouterr().out
