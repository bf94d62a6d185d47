"""What `watch` and `new network` refuse and what they take; what is concluded of a protocol."""

import os
from pathlib import Path
from types import SimpleNamespace as Of

import pytest

from innervate.cli import errors, making, watching
from innervate.cli.watching import Settings
from innervate.web.errors import WatchError

PLAIN = Settings([], None, None)


@pytest.fixture
def served(monkeypatch):
    """What would be served: which source, where; nothing is simulated."""
    told = []

    async def serve(source, host, port, announce, report):
        told.append((source, host, port, report))
        announce("http://here")

    monkeypatch.setattr("innervate.web.serve.serve", serve)
    monkeypatch.setattr(watching, "_simulated", lambda what, settings: f"scenario {what}")
    recorded = Of(report=Path("report.html"))
    monkeypatch.setattr(watching, "_recorded", lambda folder, settings: recorded)
    monkeypatch.setattr(watching, "_live", lambda nodes, settings: f"live {' '.join(nodes)}")
    return told


def page(port=0, open_=False):
    return Of(host="::1", port=port, open_=open_)


def test_a_folder_is_a_run_but_for_live_and_what_comes_with_innervate(
    served, tmp_path, monkeypatch, capsys
):
    monkeypatch.chdir(tmp_path)
    for name in ("run", "live", "hello-skin"):
        (tmp_path / name).mkdir()
    monkeypatch.setattr("innervate.scenario.bundled", lambda: {"hello-skin"})
    for what in ("run", "hello-skin", "a.toml"):
        assert watching.watch(what, page=page(65_535)) == 0
    assert watching.watch("live", "n1", "n2", page=page()) == 0
    run, bundled, file, live = served
    assert run[1:] == ("::1", 65_535, Path("report.html"))
    assert bundled == ("scenario hello-skin", "::1", 65_535, None)
    assert file[0] == "scenario a.toml"
    assert live == ("live n1 n2", "::1", 0, None)
    assert capsys.readouterr().out.splitlines()[:2] == ["Open http://here", "Ctrl-C ends it."]


@pytest.mark.parametrize("is_open", [False, True])
def test_a_browser_is_opened_if_one_is_wanted(served, monkeypatch, is_open):
    opened = []
    monkeypatch.setattr(watching.webbrowser, "open", opened.append)
    monkeypatch.setattr(
        watching.threading, "Thread",
        lambda target, args, daemon: Of(start=lambda: target(*args)),
    )  # fmt: skip
    watching.watch("a.toml", page=page(open_=is_open))
    assert opened == ["http://here"] * is_open


@pytest.mark.parametrize(
    ("what", "nodes", "speed", "port", "why"),
    [
        ("a.toml", [], None, -1, "--port is 0 to 65535, not -1"),
        ("a.toml", [], None, 65_536, "--port is 0 to 65535, not 65536"),
        ("a.toml", ["n1"], None, 0, '"n1" is too much'),
        ("a.toml", [], -1.0, 0, "--speed: .*, not -1"),
        ("a.toml", [], 1e6 + 1, 0, "--speed: .*, not 1e"),
        ("live", [], 0.0005, 0, "--speed: .*, not 0.0005"),
    ],
)
def test_what_watch_refuses(served, what, nodes, speed, port, why):
    with pytest.raises(errors.UserError, match=why):
        watching.watch(what, *nodes, speed=speed, page=page(port))
    assert served == []


@pytest.mark.parametrize("speed", [0, 0.001, 1e6])
def test_speeds_that_can_be(speed):
    watching._check_speed(speed)


@pytest.mark.parametrize("given", [(["seed=1"], None, None), ([], 0, None), ([], None, 0)])
def test_nodes_and_runs_are_shown_as_they_are(tmp_path, given):
    with pytest.raises(errors.UserError, match="nodes run as they are"):
        watching._live([], Settings(*given))
    if given[2] is None:
        with pytest.raises(errors.UserError, match="a run is shown as it was"):
            watching._recorded(tmp_path, Settings(*given))


@pytest.mark.parametrize(
    ("nodes", "is_there", "hint"), [([], True, True), ([], False, False), (["n1"], True, False)]
)
def test_where_no_node_runs_what_is_called_live_here_is_named(
    monkeypatch, tmp_path, nodes, is_there, hint
):
    def find(names):
        assert names == nodes
        raise WatchError("no node runs here")

    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("innervate.web.live.find", find)
    if is_there:
        (tmp_path / "live").mkdir()
    with pytest.raises(errors.UserError if hint else WatchError) as raised:
        watching._live(nodes, PLAIN)
    assert str(raised.value).endswith("innervate watch ./live") == hint


@pytest.mark.parametrize("umask", [0o022, 0o077])
@pytest.mark.parametrize(("on", "over"), [("cables", ""), ("field", "csma"), ("channel", "")])
def test_a_network_is_written_whole(tmp_path, capsys, umask, on, over):
    target, before = tmp_path / "deep" / "talk", os.umask(umask)
    try:
        assert making.make(target, on, over) == 0
    finally:
        assert os.umask(before) == umask  # as it was
    assert [path.name for path in target.parent.iterdir()] == ["talk"]
    assert target.stat().st_mode & 0o777 == 0o777 & ~umask
    texts = {path.name: path.read_text() for path in target.iterdir()}
    assert {"network.py", "protocol.py", "talk.toml"} <= set(texts)
    assert not any("NAME" in text or "OVER" in text for text in texts.values())
    assert any("csma" in text for text in texts.values()) == bool(over)
    assert capsys.readouterr().out.splitlines() == [
        f"Written: {target}, a network over {on}{', above csma' * bool(over)}. Try it:",
        f"  innervate check-protocol {target}", f"  innervate verify {target}",
        f"  innervate run {target}/talk.toml",
    ]  # fmt: skip


def test_a_network_that_cannot_be_written_leaves_nothing(tmp_path, monkeypatch):
    def fails(*_, **__):
        raise OSError(28, "no space left")

    monkeypatch.setattr(Path, "write_text", fails)
    with pytest.raises(errors.UserError, match="talk cannot be written: no space left"):
        making.make(tmp_path / "talk", "cables")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("name", "on", "over", "why"),
    [
        (None, "cables", "", "name it"), ("talk", "air", "", "--on can be .*, not 'air'"),
        ("talk", "cables", "csma", "--over can be .*, with --on field"),
        ("talk", "field", "air", "--over can be"), ("Talk", "cables", "", "is no name"),
        ("täl", "cables", "", "is no name"), ("2talk", "cables", "", "is no name"),
        ("skin", "cables", "", "is taken"), ("json", "cables", "", "is taken"),
        ("name", "cables", "", "is taken"), ("numpy", "cables", "", "is taken"),
        ("there", "cables", "", "is there already"),
    ],
)  # fmt: skip
def test_a_network_that_cannot_be_is_not_written(tmp_path, name, on, over, why):
    (tmp_path / "there").mkdir()
    with pytest.raises(errors.UserError, match=why):
        making.make(name and tmp_path / name, on, over)
    assert [path.name for path in tmp_path.iterdir()] == ["there"]


@pytest.mark.parametrize(
    ("most", "broken", "failed", "faults"),
    [
        (16, None, None, []), (17, None, "", ["the outbox is too small"]),
        (None, "loop", None, ["some order of events breaks it"]),
        (3, None, "1 failed", ["its tests fail"]),
        (99, "loop", "x", ["the outbox is too small", "some order of events breaks it",
                           "its tests fail"]),
    ],
)  # fmt: skip
def test_what_is_concluded_of_a_protocol(most, broken, failed, faults):
    said = {"outbox": {"on_frame": most, "on_timer": 2}, "broken": broken}
    if failed is not None:
        said |= {"tests_failed": failed, "reached": 7, "functions": 9}
    case = Of(record={"states": 5_000}, is_complete=most == 3)
    line = making._conclusion(said, 16, case)
    assert said["faults"] == faults
    room = f"at most {max(2, most or 0)} actions a call of 16"
    room += "" if most else " where that is seen"
    assert f"{room}, {'all' if most == 3 else 'the first'} 5,000 states explored" in line
    assert ("values and frames fit" in line) == (not faults)
    assert line.endswith("7 of 9 functions reached by tests") == (failed == "")


def test_a_protocol_is_explored_on_two_nodes_in_so_many_states(monkeypatch):
    asked = []
    case = Of(record={"broken": None, "states": 5_000}, lines=["a line"], is_complete=True)

    def explore(network, **how):
        asked.append(how)
        return (case,)

    monkeypatch.setattr("innervate.running.exploring.explore", explore)
    monkeypatch.setattr(
        making.folders,
        "actions_of",
        lambda *_: {"on_frame": (17, "a.py:3"), "on_timer": (None, "a.py:9")},
    )
    network, said, lines = Of(parts={}, package="own", protocol=Of(), name="own"), {}, []
    making._look_further(Path(), network, False, said, lines)
    assert asked == [{"graph": "pair", "states": 5_000}]
    assert (said["outbox"], said["broken"]) == ({"on_frame": 17, "on_timer": None}, None)
    assert lines[:3] == [
        "a.py:3: on_frame may put 17 actions, the outbox holds 16; write OUTBOX = 17",
        "a.py:9: on_timer: how many actions it may put is not seen from its loops; the outbox "
        "holds 16", "a line",
    ]  # fmt: skip
    assert lines[3].startswith("own: the dialect is kept, but: the outbox is too small")
