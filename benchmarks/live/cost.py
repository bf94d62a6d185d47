"""python -m benchmarks.live.cost: what a node costs: start, memory, a frame's bytes, its seal.

Start: from the command to "ready", of a mesh node with one UDP path. Frames: a message of 90 bytes.
"""

import argparse
import json
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from benchmarks.live.sides import cpu_s, memory_mib
from innervate.dialect import plain
from innervate.live.keys import Sealer
from innervate.live.state import State
from innervate.networks.mesh import frames as mesh
from innervate.networks.mesh.protocol import constants as mesh_const
from innervate.networks.mesh.protocol import fields as mesh_fields

REPEATS = 5
PAYLOAD = 90
HEAVY = ("numpy", "numba", "polars")


def node_file(folder, sealed):
    lines = ['kind = "mesh"', "number = 0", "nodes = 2", 'role = "gateway"',
             f"socket = {json.dumps(str(folder / 'n0.sock'))}"]  # fmt: skip
    if sealed:
        lines += ["[keys]", "use = 1", f'secret.1 = "{"ab" * 32}"']
    lines += ["[[link]]", 'kind = "udp"', 'bind = "127.0.0.1:0"', 'peers = ["127.0.0.1:9"]']
    path = folder / "n0.toml"
    path.write_text("\n".join(lines) + "\n")
    return path


def started(folder, sealed):
    """Of one start: seconds to the line that says ready, of CPU; MiB and heavy libraries then."""
    command = [Path(sys.executable).with_name("innervate"), "live", "node"]
    began = time.monotonic()
    node = subprocess.Popen([*command, node_file(folder, sealed)], stderr=subprocess.PIPE)
    said = node.stderr.readline()
    took = time.monotonic() - began
    assert b"ready" in said, said
    maps = Path(f"/proc/{node.pid}/maps").read_text()
    found = (
        took,
        cpu_s(node.pid),
        memory_mib(node.pid),
        [name for name in HEAVY if f"/{name}/" in maps],
    )
    node.terminate()
    node.wait()
    return found


def microseconds(what, inputs):
    """The least mean time of a call, of several rounds: other work on the machine only adds."""
    rounds, size = [], len(inputs) // REPEATS
    for part in (inputs[i * size : (i + 1) * size] for i in range(REPEATS)):
        began = time.perf_counter()
        for one in part:
            what(one)
        rounds.append((time.perf_counter() - began) / len(part))
    return 1e6 * min(rounds)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--starts", type=int, default=10)
    parser.add_argument("--frames", type=int, default=20_000)
    args = parser.parse_args()
    for sealed in (False, True):
        with tempfile.TemporaryDirectory() as folder:
            starts = [started(Path(folder), sealed) for _ in range(args.starts)]
        times, cpu, sizes, heavy = zip(*starts, strict=True)
        what = "with a key" if sealed else "no key"
        print(
            f"{what:11} start {statistics.median(times):.2f} s "
            f"({min(times):.2f} to {max(times):.2f}), CPU {statistics.median(cpu):.2f} s, "
            f"{max(sizes):.1f} MiB, loaded of {', '.join(HEAVY)}: {heavy[0] or 'none'}"
        )
    frame = plain.make("Frame", mesh_fields.FRAME)()
    frame.kind, frame.length, frame.origin, frame.dest = mesh_const.DATA, PAYLOAD, 1, 2
    data = mesh.encode(frame)
    here, there = (Sealer("mesh", i, {1: bytes(32)}, 1, State(None)) for i in (0, 1))
    sealed_frames = [here.close(data) for _ in range(args.frames)]
    costs = {
        "frame to bytes": microseconds(mesh.encode, [frame] * args.frames),
        "bytes to frame": microseconds(lambda _: mesh.decode(data, frame), sealed_frames),
        "seal": microseconds(here.close, [data] * args.frames),
        "open": microseconds(lambda data: there.take(there.open(data)), sealed_frames),
    }
    print(f"a frame of {len(data)} bytes, sealed {len(sealed_frames[0])}: "
          + ", ".join(f"{what} {us:.1f} us" for what, us in costs.items()))  # fmt: skip


if __name__ == "__main__":
    main()
