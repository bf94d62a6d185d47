"""Managed flooding and RPL as whole networks: run, explored, live, as C."""

import shutil
import subprocess
from pathlib import Path

import pytest

import innervate
from innervate import folders
from innervate.cli import main
from innervate.network import networks, read
from innervate.networks.rpl.protocol import constants as c

EXAMPLES = Path(__file__).parents[2] / "examples" / "field"
HOME = Path(innervate.__file__).parent / "networks"
NAMES = ("flooding", "rpl")
LINE = [{"nodes": [k, k + 1], "quality": 1.0} for k in range(4)]


def ran(name, **changes):
    return innervate.run(EXAMPLES / f"{name}.toml", plain=True, overrides=changes)


def in_line(name, inputs, **changes):
    """Five nodes in a row; nobody dies."""
    given = {"nodes": 5, "link": LINE, "event": [], "input": inputs, "duration_s": 8.0}
    return ran(name, **given | changes)


@pytest.mark.parametrize("name", NAMES)
def test_its_folder_is_one_as_users_have(name):
    network = read(HOME / name)
    assert [str(one) for one in folders.findings((HOME / name).resolve(), network)] == []
    for most, where in folders.actions_of((HOME / name).resolve(), network).values():
        assert most <= network.protocol.OUTBOX, where


@pytest.mark.parametrize("name", NAMES)
def test_nothing_breaks_in_whatever_order_things_happen(name):
    for graph, budget in (("pair", ""), ("line", "restart=0"), ("ring", "loss=2,restart=0")):
        (case,) = innervate.explore(name, graph=graph, budget=budget, states=400)
        assert not case.is_broken, case.lines
        assert case.lines[0].startswith("n0 - n1")  # who hears whom: there are no cables


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_nothing_breaks_in_many_more(name):
    for case in innervate.explore(name, budget="loss=2,restart=1,input=2", states=20_000):
        assert not case.is_broken, case.lines


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("action", ["restart", "revive"])
def test_who_comes_back_is_who_it_was_and_draws_other_numbers(name, action):
    """Once it came back as node 0, the root, with the same random numbers for ever."""
    event = [{"at_s": 1.0, "action": "kill", "node": 3}] * (action == "revive")
    event += [{"at_s": 1.1, "action": action, "node": 3}]
    back, never = (in_line(name, [], event=some, duration_s=4.0).result.world.stations
                   for some in (event, []))  # fmt: skip
    for node in range(5):
        assert (back[node].number, back[node].choice) == (node, never[node].choice)
    assert back[3].rng != never[3].rng
    assert back[3].rng > 1


def test_a_root_that_forgets_twice_breaks_nothing():
    """Its second life begins with a version that others have left behind."""
    event = [{"at_s": at, "action": "restart", "node": 0} for at in (1.0, 2.0, 3.0)]
    run = in_line("rpl", [], event=event, duration_s=6.0)
    stations = run.result.world.stations
    assert len({stations[node].version for node in range(5)}) == 1
    assert all(stations[node].rank < c.INFINITE for node in range(5))


def test_a_flood_goes_as_far_as_its_hops():
    once = [{"at_s": 1.0, "node": 0, "item": {"dest": 255}}]
    for hops, got in ((1, [1, 2]), (3, [1, 2, 3, 4])):
        run = in_line("flooding", once, **{"protocol.hops": hops})
        assert sorted(run.result.rows["deliveries"]["node"].tolist()) == got


def test_a_direct_message_is_acknowledged_from_the_far_end():
    once = [{"at_s": 1.0, "node": 0, "item": {"dest": 4}}]
    run = in_line("flooding", once)
    assert run.summary["messages"]["delivered"] == 1
    reports = run.result.rows["rows"]
    acked = reports[reports["code"] == networks()["flooding"].protocol.REPORT_ACKED]
    assert acked["node"].tolist() == [0], "heard again, or from the recipient, whichever is sooner"


@pytest.mark.parametrize("storing", [0, 1])
def test_rpl_goes_from_anywhere_to_anywhere(storing):
    pairs = [(a, b) for a in range(5) for b in range(5) if a != b]
    inputs = [{"at_s": 4.0 + k / 10, "node": a, "item": {"dest": b}}
              for k, (a, b) in enumerate(pairs)]  # fmt: skip
    run = in_line("rpl", inputs, **{"protocol.storing": storing})
    assert run.summary["messages"] == run.summary["messages"] | {"sent": 20, "delivered": 20}
    ranks = [node.rank // 128 for node in run.result.world.stations[:5]]
    assert ranks == [1, 2, 3, 4, 5]


@pytest.mark.parametrize("storing", [0, 1])
def test_rpl_repairs_itself_round_a_death(storing):
    """Two ways lead from 0 to 4: the node that dies is the parent of 3, or 3 was on the other."""
    links = [{"nodes": pair, "quality": 1.0} for pair in ([0, 1], [0, 2], [1, 3], [2, 3], [3, 4])]
    inputs = [{"at_s": 3.0, "every_s": 0.5, "node": 4, "kind": 2},
              {"at_s": 3.2, "every_s": 0.5, "node": 0, "item": {"dest": 4}}]  # fmt: skip
    changes = {"link": links, "duration_s": 12.0, "protocol.storing": storing}
    before = in_line("rpl", [], **changes).result.world.stations[3]
    parent = before.nbr[before.parent]
    event = [{"at_s": 5.0, "action": "kill", "node": parent}]
    run = in_line("rpl", inputs, event=event, **changes)
    after = run.result.world.stations[3]
    assert after.nbr[after.parent] == 3 - parent
    deliveries = run.result.rows["deliveries"]
    late = deliveries[deliveries["time"] > 8_000_000]
    assert sorted(set(late["node"].tolist())) == [0, 4]
    assert len(late) == 16


def test_a_root_that_is_revived_is_found_again():
    inputs = [{"at_s": 3.0, "every_s": 0.5, "node": 4, "kind": 2}]
    event = [
        {"at_s": 4.0, "action": "kill", "node": 0},
        {"at_s": 8.0, "action": "revive", "node": 0},
    ]
    run = in_line("rpl", inputs, event=event, duration_s=16.0)
    times = run.result.rows["deliveries"]["time"]
    assert not ((times > 4_000_000) & (times < 8_000_000)).any()
    assert (times > 14_000_000).sum() >= 4
    assert run.result.world.stations[0].version == 241, "beyond what the others know"
    detached = run.result.rows["rows"]["code"] == c.REPORT_DETACHED
    assert set(run.result.rows["rows"]["node"][detached].tolist()) == {1, 2, 3, 4}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "changes"), [("flooding", {}), ("rpl", {}), ("rpl", {"protocol.storing": 0})]
)
def test_compiled_is_as_plain(name, changes):
    small = {"nodes": 12, "duration_s": 6.0, "event": [{"at_s": 4.0, "action": "kill", "node": 5}]}
    small["input"] = [{"at_s": 2.0, "every_s": 0.5, "node": 11, "kind": 2, "item": {"dest": 3}}]
    plain, compiled = (
        innervate.run(EXAMPLES / f"{name}.toml", plain=plain, overrides=small | changes)
        for plain in (True, False)
    )
    assert plain.result.fingerprint == compiled.result.fingerprint
    assert plain.summary["messages"] == compiled.summary["messages"]


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_its_c_compiles(name, tmp_path, capsys):
    if shutil.which("gcc") is None:
        pytest.skip("gcc is not installed")
    assert main(["firmware", name, "--out", str(tmp_path)]) == 0
    for source in sorted(tmp_path.glob("*.c")):
        command = ["gcc", "-std=c99", "-Wall", "-Wextra", "-Werror", "-c", str(source)]
        subprocess.run([*command, "-I", str(tmp_path), "-o", "/dev/null"], check=True)
    capsys.readouterr()


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_it_comes_up_between_processes(name, capsys):
    changes = [word for text in ("nodes=9", "event=[]", "input=[]") for word in ("--set", text)]
    assert main(["live", "up", str(EXAMPLES / f"{name}.toml"), "--for", "1", *changes]) == 0
    assert "9 nodes and" in capsys.readouterr().out


@pytest.mark.parametrize("name", NAMES)
def test_the_example_runs(name):
    run = ran(name, duration_s=9.0, event=[])
    messages = run.summary["messages"]
    assert messages["delivered"] >= messages["sent"] >= 8
