"""What a command line asks for, before anything of it is done."""

import json
from pathlib import Path
from types import SimpleNamespace

import pytest

from innervate import network
from innervate.cli import app, exporting
from innervate.cli.errors import UserError
from innervate.cli.options import ExportOptions, UpOptions


@pytest.fixture
def used(monkeypatch):
    folders = []
    monkeypatch.setattr(network, "use", folders.append)
    return folders


@pytest.mark.parametrize(
    ("tokens", "left", "folders"),
    [
        ([], [], []),
        (["run", "a.toml"], ["run", "a.toml"], []),
        (["--network", "x", "run", "a.toml"], ["run", "a.toml"], ["x"]),
        (["run", "--network", "x", "a.toml", "--network=y"], ["run", "a.toml"], ["x", "y"]),
        (["run", "a.toml", "--network", "x"], ["run", "a.toml"], ["x"]),
        (["run", "--network=", "x"], ["run"], ["x"]),
        (["run", "--networks", "x"], ["run", "--networks", "x"], []),
        (["new", "mesh", "--network", "x"], ["new", "mesh", "--network", "x"], []),
        (["--network", "x", "new", "--network=y"], ["new", "--network=y"], ["x"]),
    ],
)
def test_networks_of_ones_own_are_named_anywhere_but_behind_new(used, tokens, left, folders):
    assert app._with_networks(tokens) == left
    assert used == [Path(name) for name in folders]


@pytest.mark.parametrize("tokens", [["--network"], ["run", "a.toml", "--network="]])
def test_a_network_needs_a_folder(used, tokens):
    with pytest.raises(UserError, match="--network needs a folder"):
        app._with_networks(tokens)
    assert used == []


def source(duration_us=2_000_000):
    made = object.__new__(exporting._Source)
    made.plan = SimpleNamespace(duration_us=duration_us)
    return made


@pytest.mark.parametrize(
    ("from_s", "to_s", "window"),
    [
        (0.0, None, (0, 2_000_000)),
        (1.9999995, None, "the run ends at 2 s; choose an earlier --from"),
        (1.999999, None, (1_999_999, 2_000_000)),
        (2.0, 3.0, "the run ends at 2 s"),
        (0.5, 0.500001, (500_000, 500_001)),
        (0.5, 0.5, "nothing lies in that window"),
        (0.0, 0.0, "nothing lies in that window"),
        (-0.000001, 1.0, "nothing lies in that window"),
        (0.5, 9.0, (500_000, 9_000_000)),
    ],
)
@pytest.mark.parametrize("pcapng", [None, Path("x.pcapng")])
def test_a_window_lies_in_the_run(from_s, to_s, window, pcapng):
    wanted = ExportOptions(pcapng=pcapng, from_s=from_s, to_s=to_s)
    if isinstance(window, tuple):
        assert source()._window(wanted) == window
        source()._check(wanted)
        return
    with pytest.raises(UserError, match=window):
        source()._window(wanted)
    if pcapng is None:
        source()._check(wanted)  # nobody asked for it
    else:
        with pytest.raises(UserError, match=window):
            source()._check(wanted)


@pytest.mark.parametrize(
    ("of", "given", "why"),
    [
        ("a.toml", {}, "nothing to export"),
        (None, {"mcap": Path("x")}, "of what"),
        ("a.toml", {"mcap": Path("x"), "csv": True}, "--csv is for tables"),
    ],
)
def test_what_is_missing_is_said(of, given, why):
    with pytest.raises(UserError, match=why):
        exporting.export(of, wanted=ExportOptions(**given))


@pytest.mark.parametrize(
    ("of", "given", "where", "files"),
    [(None, {}, None, False), ("there", {}, Path("there"), False),
     ("there", {"mcap": Path("x"), "set_": ["seed=4"], "seed": 7}, None, True)],
)  # fmt: skip
def test_the_dissector_is_written_alone_or_besides(monkeypatch, capsys, of, given, where, files):
    asked = []
    made = SimpleNamespace(write=asked.append)
    monkeypatch.setattr(exporting.dissector, "install", lambda to: asked.append(to) or "x.lua")
    monkeypatch.setattr(exporting, "_Source", lambda *given: asked.append(given) or made)
    wanted = ExportOptions(dissector=True, **given)
    assert exporting.export(of, wanted=wanted) == 0
    assert asked == [*([("there", ["seed=4"], 7), wanted] if files else []), where]
    assert "Written: x.lua" in capsys.readouterr().out


def test_a_run_is_exported_as_it_was(tmp_path):
    for sets, seed in ((["seed=1"], None), ([], 0)):
        with pytest.raises(UserError, match=r"was run as it is; export its scenario\.toml"):
            exporting._Source(str(tmp_path), sets, seed)


@pytest.mark.parametrize(("given", "cables", "keys"), [
    ((), "udp", ""), (("pty",), "pty", ""), (("netns",), "netns", ""),
    (("netns", "pty"), "netns", ""), (("sealed",), "udp", "key"),
    (("identities",), "udp", "identities"), (("pty", "sealed", "identities"), "pty", "key"),
])  # fmt: skip
def test_what_nodes_are_joined_by_and_sealed_with(given, cables, keys):
    options = UpOptions(**dict.fromkeys(given, True))
    assert (options.cables, options.keys) == (cables, keys)


@pytest.mark.parametrize(("more", "fingerprint"), [
    ({"fingerprint": "ab"}, "ab"), ({}, ""), ({"fingerprint": "ab", "interrupted_at_s": 0.1}, ""),
])  # fmt: skip
def test_a_run_that_was_interrupted_is_not_held_to_its_fingerprint(tmp_path, more, fingerprint):
    """What is simulated anew for a capture goes on to its end."""
    (tmp_path / "scenario.toml").write_text('kind = "skin"\nduration_s = 0.1\n[[patch]]\n'
                                            "columns = 2\nrows = 1\n[[interface]]\nrow = 0\n"
                                            'column = 0\nport = "W"\n')  # fmt: skip
    for name, content in (("summary", more), ("provenance", {})):
        (tmp_path / f"{name}.json").write_text(json.dumps(content))
    found = exporting._Source(str(tmp_path), [], None)
    assert (found.fingerprint, found.plan.duration_us) == (fingerprint, 100_000)
