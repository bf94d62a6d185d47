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
from innervate.live.identity import enrol
from innervate.live.keyring import MAC_BYTES, About, Keyring, Proven
from innervate.live.session import Session
from innervate.networks.mesh import frames as mesh
from innervate.networks.mesh.protocol import constants as mesh_const
from innervate.networks.mesh.protocol import fields as mesh_fields
from innervate.wire import seal

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
    here, there = sessions()
    sealed_frames = [here.close(data) for _ in range(args.frames)]
    costs = {
        "frame to bytes": microseconds(mesh.encode, [frame] * args.frames),
        "bytes to frame": microseconds(lambda _: mesh.decode(data, frame), sealed_frames),
        "seal": microseconds(here.close, [data] * args.frames),
        "open": microseconds(lambda data: opened(there, data), sealed_frames),
    }
    print(f"a frame of {len(data)} bytes, sealed {len(sealed_frames[0])}: "
          + ", ".join(f"{what} {us:.1f} us" for what, us in costs.items()))  # fmt: skip
    tell_handshakes(200)


def sessions():
    """Both ends of a session."""
    keys, who = (bytes(32), bytes([1]) * 32), Proven(1, bytes(8), 1)
    return Session(1, 2, keys, who, True), Session(2, 1, keys[::-1], who, False)


def opened(session, data):
    """A sealed frame as a node takes it."""
    _kind, _index, counter = seal.fields(data)
    assert session.window.is_new(counter)
    session.open(counter, data)
    session.window.take(counter)


def handshake(rings):
    """A handshake between two keyrings, of nodes 0 and 1; the bytes of its messages."""
    about = About(0, 0xFFFF, bytes(8), 1, "10.0.0.1:4700", "10.0.0.2:4700")
    sides, sizes = [rings[k].handshake(rings[k].use, k == 0) for k in (0, 1)], []
    while not sides[0].is_done:
        k = len(sizes) % 2
        certificate = rings[k].certificate if sizes else b""
        said = about._replace(number=k, certificate=certificate)
        head = bytes(5 if sizes else 1)
        message = rings[k].close(rings[k].use, head + sides[k].write(said.encode()))
        assert rings[1 - k].is_marked(rings[k].use, message)
        sides[1 - k].read(message[len(head) : -MAC_BYTES])
        if certificate:
            rings[1 - k].prove(said, rings[k].use, sides[1 - k].far_static)
        sizes.append(len(message))
    return sizes


def tell_handshakes(count):
    """What a first contact costs, both sides together."""
    for what, rings in (
        ("network key", [Keyring(1, {1: bytes(32)}, 1) for _ in range(2)]),
        ("identities", [Keyring(1, {}, 0, enrol(bytes(32), k, k, bytes(32))) for k in (0, 1)]),
    ):
        us = microseconds(handshake, [rings] * count)
        print(f"handshake, {what}: messages of {handshake(rings)} bytes, {us:.0f} us")
    ring = Keyring(1, {1: bytes(32)}, 1)
    us = microseconds(lambda data: ring.is_marked(1, data), [bytes(100)] * count)
    print(f"a stranger's first message: {us:.1f} us")


if __name__ == "__main__":
    main()
