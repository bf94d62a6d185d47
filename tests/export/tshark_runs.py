"""tshark with the generated dissector, for the tests."""

import os
import shutil
import subprocess

import pytest

from innervate.export import dissector


@pytest.fixture(scope="session")
def tshark(tmp_path_factory):
    """Runs tshark on a capture with some arguments: the lines that it prints."""
    return runner(tmp_path_factory.mktemp("home"))


def runner(home):
    """The same, with the dissector as it is now in a user's folder."""
    program = shutil.which("tshark")
    if program is None:
        pytest.skip("tshark is not there (Debian package tshark)")
    plugins = home / ".local/lib/wireshark/plugins"
    dissector.install(plugins)
    env = {"HOME": str(home), "PATH": os.environ["PATH"], "LC_ALL": "C.UTF-8"}

    def run(capture, *arguments):
        done = subprocess.run(
            [program, "-r", str(capture), *arguments],
            capture_output=True, text=True, timeout=120, check=False, env=env,
        )  # fmt: skip
        assert done.returncode == 0, done.stderr
        assert "Lua" not in done.stderr, done.stderr
        return done.stdout.splitlines()

    return run


def fields_of(tshark, capture, names, *arguments):
    """A dictionary per packet: of every field that it has all values, as texts."""
    chosen = [word for name in names for word in ("-e", name)]
    how = ("-E", "occurrence=a", "-E", "aggregator=,", "-E", "separator=/t")
    lines = tshark(capture, "-T", "fields", *how, *chosen, *arguments)
    return [
        {name: text.split(",") for name, text in zip(names, line.split("\t"), strict=True) if text}
        for line in lines
    ]
