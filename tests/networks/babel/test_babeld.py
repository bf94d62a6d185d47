"""A live node of Babel and babeld, the RFC's first implementation, are neighbours."""

import json
import os
import shutil
import subprocess
import sys
import time
from contextlib import ExitStack, contextmanager
from pathlib import Path

import pytest

from innervate.live.netns import Lab

PC = "fd69:6e6e:6572:7661:696e:6e65:7276:0"
OURS, THEIRS = 0, 1  # network namespaces, with cable c0 between them
RELAY = Path(__file__).with_name("relay.py")
FILE = """kind = "babel"
name = "own"
number = {number}
[protocol]
hello_us = 200_000
update_hellos = 4
up_least = 2
up_of = 3
nominal = 96
urgent_us = 100_000
copies = 2
request_us = 500_000
gc_us = 180_000_000
[[link]]
kind = "udp"
bind = "127.0.0.1:7001"
peers = ["127.0.0.1:7002"]
"""
pytestmark = [pytest.mark.slow, pytest.mark.needs_root, pytest.mark.needs_netns]


def until(asked, limit_s=30):
    """What is asked for, as soon as there is something."""
    end = time.monotonic() + limit_s
    while not (found := asked()):
        assert time.monotonic() < end, "it never came"
        time.sleep(0.1)
    return found


@contextmanager
def neighbours(folder, number, *settings):
    """A node of ours behind a relay, and babeld; the lab, and what to ask our node."""
    if shutil.which("babeld") is None:
        pytest.skip("babeld is not installed")
    env = os.environ | {"INNERVATE_RUN": str(folder)}
    innervate = [sys.executable, "-m", "innervate.cli"]
    (folder / "own.toml").write_text(FILE.format(number=number))
    lab = Lab("ivbabel", 2, [(OURS, THEIRS)])
    lab.up()
    babeld = ["babeld", "-h", "0.2", "-H", "0.2", "-S", str(folder / "state"), "-I", "",
              *(word for one in settings for word in ("-C", one)),
              "-C", "redistribute local deny", "c0"]  # fmt: skip
    with ExitStack() as ending:
        ending.callback(lab.down)
        own = f"fe80::696e:6e65:7276:{number}/64"
        lab.run(OURS, ["ip", "addr", "add", own, "dev", "c0", "nodad"])
        lab.run(THEIRS, ["ip", "addr", "add", f"{PC}/128", "dev", "lo"] if number else ["true"])
        until(lambda: "tentative" not in lab.run(THEIRS, ["ip", "-6", "addr", "show", "dev", "c0"]))
        for node, command in (
            (OURS, [sys.executable, str(RELAY), "7002", "7001", "c0"]),
            (OURS, [*innervate, "live", "node", str(folder / "own.toml")]),
            (THEIRS, babeld),
        ):
            process = subprocess.Popen(lab.inside(node, command), env=env, cwd=folder)
            ending.callback(process.wait)
            ending.callback(process.terminate)

        def fields():
            asked = [*innervate, "live", "status", "own", "--json"]
            told = subprocess.run(asked, env=env, capture_output=True, text=True, check=False)
            return json.loads(told.stdout)["fields"] if told.returncode == 0 else None

        yield lab, fields


def test_babeld_learns_the_way_to_our_source(tmp_path):
    with neighbours(tmp_path, 0) as (lab, fields):
        known = f"{PC} via fe80::696e:6e65:7276:0 dev c0 proto babel"
        until(lambda: known in lab.run(THEIRS, ["ip", "-6", "route", "show", PC]))
        assert fields()["cost"][0] == 96, "babeld says IHU, too"


def test_we_learn_the_way_to_a_source_of_babeld(tmp_path):
    known = ("router-id 69:6e:6e:65:72:76:00:00", f"redistribute local ip {PC}/128 allow")
    with neighbours(tmp_path, 1, *known) as (_lab, fields):
        found = until(lambda: (found := fields()) and found["parent"] == 0 and found)
        assert (found["metric"][0], found["cost"][0], found["fd_metric"]) == (0, 96, 96)
