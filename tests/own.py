"""A network of one's own for tests: written by `innervate new network`, and changed."""

import contextlib
import io
import shutil
import sys
from importlib import import_module

import numpy as np
import pytest

import innervate
from innervate import folders
from innervate.cli import main
from innervate.network import networks


class Own:
    """A folder made by the command."""

    def __init__(self, folder):
        self.folder = folder
        self.scenario = folder / f"{folder.name}.toml"

    def change(self, file, old, new):
        """Change one place of a file."""
        path = self.folder / file
        text = path.read_text()
        assert text.count(old) == 1, (file, old)
        path.write_text(text.replace(old, new))

    def rewrite(self, name, text):
        """Put another function in the place of one of the protocol's, up to the next."""
        path = self.folder / "protocol.py"
        before, _, after = path.read_text().partition(f"def {name}(")
        _, following, rest = after.partition("\n\n\ndef ")
        path.write_text(before + text.rstrip() + (following + rest if following else "\n"))

    def line(self, file, text):
        """The number of the first line that has a text."""
        lines = (self.folder / file).read_text().splitlines()
        return next(number for number, line in enumerate(lines, 1) if text in line)


def at_once(kind, **fields):
    """An `on_input` that sends a frame of a kind as soon as a node is given something."""
    lines = ["def on_input(node, params, now, kind, item, out):", "    'Send it now.'",
             "    frame = out.frame[send(out, 0, 0, 0)]", f"    frame.kind = {kind}"]  # fmt: skip
    lines += [f"    frame.{name} = {value}" for name, value in fields.items()]
    return "\n".join([*lines, "    frame.made_at = item.made_at", ""])


@pytest.fixture
def alone(monkeypatch, tmp_path):
    """The working folder is an empty one, and no other folders are known."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("INNERVATE_NETWORKS", "")
    # Of a file that is edited within a second, to the same length, Python finds the older one.
    monkeypatch.setattr(sys, "dont_write_bytecode", True)
    monkeypatch.setenv("PYTHONDONTWRITEBYTECODE", "1")
    # A folder's own tests want none of what is installed for ours, which takes a second to load.
    monkeypatch.setenv("PYTEST_DISABLE_PLUGIN_AUTOLOAD", "1")
    networks.cache_clear()
    yield tmp_path
    for name in list(folders._stamps):
        folders._forget(folders._home(name))
    networks.cache_clear()


@pytest.fixture
def plain(monkeypatch):
    """Runs of own networks are plain ones: each would be compiled anew, for half a minute."""
    for medium in ("cables", "channel", "field"):
        module = import_module(f"innervate.sim.{medium}.declared")

        def plainly(plan, begun=module.simulation, **kept):
            return begun(plan, **kept | {"plain": True})

        monkeypatch.setattr(module, "simulation", plainly)


def made(folder, medium="cables", over=""):
    """A network's folder of the medium, above a medium access if one is named."""
    shutil.rmtree(folder, ignore_errors=True)
    below = ["--over", over] if over else []
    with contextlib.redirect_stdout(io.StringIO()):
        assert main(["new", "network", str(folder), "--on", medium, *below]) == 0
    return Own(folder)


@pytest.fixture
def own(alone):
    """A network over cables called gossip, as it is written."""
    return made(alone / "gossip")


@pytest.fixture
def talk(alone):
    """A network on a channel, as it is written."""
    return made(alone / "talk", "channel")


@pytest.fixture
def bare(alone):
    """A network over a field with no medium access below it, as it is written."""
    return made(alone / "flood", "field")


def refused(network, capsys, command="check"):
    """The one line that a command says of its scenario, or of what that stands on."""
    assert main([command, str(network.scenario)]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    return line


def run_both_ways(network):
    """Its scenario's run, compiled and plain: they must be the same, row by row."""
    one, other = (innervate.run(network.scenario, plain=plain).result for plain in (False, True))
    assert one.fingerprint == other.fingerprint
    assert one.counts == other.counts
    for name in ("rows", "deliveries"):
        assert np.array_equal(one.rows[name], other.rows[name])
