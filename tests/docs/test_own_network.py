"""docs/own-network.md, command by command and file by file, in an empty folder."""

import re
import shlex
import subprocess
import sys
from pathlib import Path

from innervate.cli import main
from innervate.network import networks
from tests.own import alone, plain

__all__ = ["alone", "plain"]
PAGE = Path(__file__).resolve().parents[2] / "docs" / "own-network.md"
# A page is served by a process of its own, which would compile the loop before it says where;
# tokenring/test_watch.py looks at a page whose loop is compiled.
WATCH = (
    "import sys; from innervate.sim.driver import Simulation; from innervate.cli import main\n"
    "Simulation.prepare = lambda self: None\n"
    "sys.exit(main())"
)
STEP = re.compile(
    r"<!-- file: (?P<file>\S+) -->\n```\w+\n(?P<text>.*?)```"
    r"|<!-- in (?P<edited>\S+) -->\n```python\n(?P<added>.*?)```"
    r"|```console\n(?P<said>.*?)```|```python\n(?P<code>.*?)```",
    re.DOTALL,
)


def commands(block):
    """(command, lines that it says) of a console block."""
    for part in re.split(r"^\$ ", block, flags=re.MULTILINE)[1:]:
        first, *lines = part.splitlines()
        yield first, lines


def carried_out(command, capfd):
    """What a command says."""
    words = shlex.split(command)
    if words[:2] == ["innervate", "watch"]:
        with subprocess.Popen([sys.executable, "-c", WATCH, *words[1:]],
                              stdout=subprocess.PIPE, text=True) as page:  # fmt: skip
            line = page.stdout.readline()
            page.kill()  # asked to end, it would first have compiled the loop
        return line
    if words[0] == "innervate":
        assert main(words[1:]) in (0, 1, 2), command
        out, err = capfd.readouterr()
        return out + err
    words = [sys.executable, *words[1:]]
    done = subprocess.run(words, capture_output=True, text=True, check=False)
    return done.stdout + done.stderr


def parts():
    """The page but for channel and field, and what it says of each."""
    before, rest = PAGE.read_text(encoding="utf-8").split("## On a shared channel")
    channel, field, after = rest.split("\n## ", 2)
    return before + "## " + after, channel, field


def test_every_step_of_the_page(alone, plain, capfd):
    assert played(parts()[0], capfd) >= 15
    assert {"gossip", "ring"} <= set(networks())


def test_every_step_on_the_channel(alone, plain, capfd):
    assert played(parts()[1], capfd) == 7


def test_every_step_over_a_field(alone, plain, capfd):
    assert played(parts()[2], capfd) == 9


def played(text, capfd):
    """Carry out all steps of a text; how many commands there were."""
    count = 0
    for step in STEP.finditer(text):
        if step["file"]:
            Path(step["file"]).write_text(step["text"])
        elif step["edited"]:
            path = Path(step["edited"])
            path.write_text(path.read_text() + "\n\n" + step["added"])
        elif step["code"]:
            exec(compile(step["code"], str(PAGE), "exec"), {})
        else:
            for command, lines in commands(step["said"]):
                said = carried_out(command, capfd)
                count += 1
                for line in filter(None, lines):
                    assert line.rstrip(". ") in said, (command, line, said)
        capfd.readouterr()
    return count
