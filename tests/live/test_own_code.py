"""A live node whose network's code breaks ends, and that is told with file and line."""

import json
import subprocess
import sys

from tests.own import alone, own

__all__ = ["alone", "own"]


def test_the_line_that_broke_is_told_and_the_others_go_on(own):
    own.change("fields.py", '("value", 0, 0, 255, "raw", "what it says"),',
               '("value", 0, 0, 255, "raw", "what it says"),\n'
               '    ("seen", 4, 0, 1, "flag", "by port"),')  # fmt: skip
    own.change("protocol.py", "    node.value = item.value\n",
               "    node.value = item.value\n    node.seen[node.number - 4] = 1\n")  # fmt: skip
    inputs = ", ".join(f"{{at_s={at_s}, node={node}, item={{value=1}}}}"
                       for at_s, node in ((0.1, 4), (0.2, 0)))  # fmt: skip
    command = [sys.executable, "-m", "innervate.cli", "live", "up", own.scenario, "--for", "2",
               "--json", "--set", "nodes=5", "--set", "event=[]",
               "--set", f"input=[{inputs}]"]  # fmt: skip
    done = subprocess.run(command, capture_output=True, text=True, timeout=120, check=False)
    told = [json.loads(line) for line in done.stdout.splitlines()]
    line = own.line("protocol.py", "node.seen[node.number - 4]")
    why = f"{own.folder}/protocol.py:{line}: IndexError: [-4]: an index is 0 to 3, in on_input"
    assert told[1:] == [{"ended": "n0", "why": why}]
    assert done.returncode == 1
