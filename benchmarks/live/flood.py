"""python -m benchmarks.live.flood: what messages of others suffer while strangers send noise.

Three nodes on a line, as processes on loopback, 50 messages a second over the one in the middle;
then the same while another process sends it 100,000 datagrams a second. Plain and sealed. Exit
code 1 if a message was lost, a node wrote an error, a stranger got an answer, or p99 is 5 ms.
"""

import argparse
import subprocess
import sys
import tempfile
from pathlib import Path

from benchmarks.live.hops import Line, ours, tell

SIZE = 64
PLAN = "r50"
P99_US = 5_000


def built(folder):
    """The program that floods."""
    program = Path(folder) / "flood"
    source = Path(__file__).with_name("flood.c")
    subprocess.run(["gcc", "-O2", "-o", program, source], check=True)
    return program


def port_of(command):
    """The port of a node, as its file says."""
    text = Path(command[1]).read_text(encoding="utf-8")
    return text.split('bind = "127.0.0.1:')[1].split('"')[0]


def flooded(program, line, port, args):
    """A row of `hops` with a flood, and what the flood says of itself."""
    words = [str(program), port, str(args.rate), str(args.seconds), str(args.seed)]
    flood = subprocess.Popen(words, stdout=subprocess.PIPE, text=True)
    found = line.measure(SIZE, args.seconds, PLAN)
    said, _ = flood.communicate()
    sent, per_s, back = map(int, said.split())
    return found, sent, per_s, back


def faults(side, found, back):
    if found["states"].keys() - {"delivered"}:
        yield f"{side}: not all messages were delivered: {found['states']}"
    if found["p99_us"] >= P99_US:
        yield f"{side}: p99 is {found['p99_us'] / 1000:.2f} ms"
    if back:
        yield f"{side}: {back} datagrams were sent to the stranger"


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--rate", type=int, default=100_000, help="datagrams a second")
    parser.add_argument("--seed", type=int, default=1)
    args = parser.parse_args()
    wrong = []
    for side in ("plain", "sealed"):
        with tempfile.TemporaryDirectory() as folder:
            program, commands = built(folder), ours(Path(folder), 3, side == "sealed")
            line = Line(commands)
            tell(side, "calm", line.measure(SIZE, args.seconds / 6, PLAN))
            found, sent, per_s, back = flooded(program, line, port_of(commands[1]), args)
            tell(side, "hurt", found)
            print(f"{sent} datagrams, {per_s} a second; {line.ask(1, 'take')['counters']}")
            line.stop()
            codes = [node.returncode for node in line.nodes]
            wrong += faults(side, found, back)
            if any(codes):
                wrong.append(f"{side}: nodes ended with {codes}")
    for text in wrong:
        print(text)
    sys.exit(bool(wrong))


if __name__ == "__main__":
    main()
