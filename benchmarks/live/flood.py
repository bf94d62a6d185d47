"""python -m benchmarks.live.flood: what messages of others suffer while somebody sends noise.

Three nodes on a line, as processes on loopback, 50 messages a second over the one in the middle;
then the same while another process sends it 100,000 datagrams a second. Plain and sealed.

--as stranger: from an address that is no neighbour's. --as neighbour (as root): from the address of
the first node, by somebody who recorded another run of the same nodes: noise, frames of the
recording with one byte changed, and what begins like them. --as listener: the same, recorded in
this run, so that the first bytes are right. --as caller: two of three are first messages of a
handshake, whose mark is wrong. --as bystander: from the address of a fourth node that has no part
in the messages, by somebody who listens to it. --group: into the multicast group of three nodes, of
which the first sends to the last; with --as listener what its members say, recorded in this run.

Exit code 1 if a message was lost, a node wrote an error or answered, or p99 is 5 ms.
"""

import argparse
import os
import socket
import subprocess
import sys
import tempfile
import time
from contextlib import contextmanager
from pathlib import Path
from threading import Thread

from benchmarks.live.hops import Line, free_ports, ours, tell

HOST = "127.0.0.1"
GROUP = "239.77.12.7"
SIZE = 64
PLAN = "r50"
P99_US = 5_000
WHOM = "stranger", "neighbour", "listener", "caller", "bystander"
ANSWERS = 1.1  # so many times what the node sends in peace is no answer to anybody
RECORD_S = 1.0
CALL_BYTES = 150
IP_BYTES, UDP_BYTES = 20, 8


def built(folder):
    """The program that floods."""
    program = Path(folder) / "flood"
    source = Path(__file__).with_name("flood.c")
    subprocess.run(["gcc", "-O2", "-o", program, source], check=True)
    return program


def port_of(command):
    """The port of a node, as its file says."""
    text = Path(command[-1]).read_text(encoding="utf-8")
    return int(text.split(f'bind = "{HOST}:')[1].split('"')[0])


def record(file, ports):
    """Write what goes from one port to another for a second, as `flood` reads it."""
    with socket.socket(socket.AF_PACKET, socket.SOCK_DGRAM, socket.htons(3)) as sock:
        sock.bind(("lo", 0))
        sock.settimeout(RECORD_S)
        frames, ends = [], time.monotonic() + RECORD_S
        while time.monotonic() < ends:
            data, whence = sock.recvfrom(2048)
            of = tuple(int.from_bytes(data[IP_BYTES + k : IP_BYTES + k + 2]) for k in (0, 2))
            if whence[2] != socket.PACKET_OUTGOING and of == ports:
                frames.append(data[IP_BYTES + UDP_BYTES :])
    file.write_bytes(b"".join(len(one).to_bytes(2, "little") + one for one in frames))


def first_message(folder):
    """A recording of nothing but a first message."""
    file = Path(folder) / "recording"
    file.write_bytes(CALL_BYTES.to_bytes(2, "little") + b"\xd1" + bytes(CALL_BYTES - 1))
    return file


def recorded(line, folder, ports):
    """A file with what went between two nodes while messages were sent."""
    file = Path(folder) / "recording"
    line.measure(SIZE, RECORD_S, PLAN)  # routes are known
    thread = Thread(target=record, args=(file, ports))
    thread.start()
    line.measure(SIZE, 2 * RECORD_S, PLAN)
    thread.join()
    return file


@contextmanager
def running(commands, log):
    """The nodes, until they are stopped in order."""
    line = Line(commands, log)
    yield line
    line.stop()
    codes = [node.returncode for node in line.nodes]
    if any(codes):
        log.write(f"nodes ended with {codes}\n")


def flooded(line, words, seconds):
    """A row of `hops` with a flood, and what the flood says of itself."""
    flood = subprocess.Popen(list(map(str, words)), stdout=subprocess.PIPE, text=True)
    found = line.measure(SIZE, seconds, PLAN)
    said, _ = flood.communicate()
    return found, list(map(int, said.split()))


def faults(calm, found, back):
    if found["states"].keys() - {"delivered"}:
        yield f"not all messages were delivered: {found['states']}"
    if found["p99_us"] >= P99_US:
        yield f"p99 is {found['p99_us'] / 1000:.2f} ms"
    if back:
        yield f"{back} datagrams were sent to the stranger"
    if found["each"] > ANSWERS * calm["each"]:
        yield f"the node sent {found['each']:.1f} frames a message, {calm['each']:.1f} in peace"


def with_rate(found, before):
    """The same row with frames that the node in the middle sent for each message."""
    count = sum(found["states"].values())
    return found | {"each": (found["middle"]["sent"] - before) / count}


def run(side, args, folder, log):
    """Calm, then a flood: what was wrong."""
    group = f"{GROUP}:{free_ports(1)[0]}" if args.group else ""
    shape = group or ("star" if args.whom == "bystander" else "line")
    count, far = (4, 2) if shape == "star" else (3, 0)
    commands = ours(Path(folder), count, side == "sealed", None, args.engine, shape)
    host, port = group.split(":") if group else (HOST, port_of(commands[1]))
    far = port if group else port_of(commands[far])  # members send from the group's port
    ports = int(far), int(port)
    words = [built(folder), host, port, args.rate, args.seconds, args.seed]
    if args.whom == "neighbour":
        with running(commands, log) as line:
            words += [far, recorded(line, folder, ports)]
    with running(commands, log) as line:
        if args.whom in ("listener", "bystander"):
            words += [far, recorded(line, folder, ports)]
        if args.whom == "caller":
            words += [far, first_message(folder)]
        start = line.ask(1, "take")["sent"]
        calm = with_rate(line.measure(SIZE, args.seconds / 6, PLAN), start)
        tell(side, "calm", calm)
        found, (sent, per_s, back) = flooded(line, words, args.seconds)
        found = with_rate(found, calm["middle"]["sent"])
        tell(side, "hurt", found)
        middle = found["middle"]
        print(f"{sent} datagrams, {per_s} a second; the node used {middle['cpu_s']:.1f} s of its "
              f"processor and {middle['mib']:.1f} MiB, and sent {found['each']:.2f} frames a "
              f"message ({calm['each']:.2f}); {middle['counters']}", flush=True)  # fmt: skip
        return list(faults(calm, found, back))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--rate", type=int, default=100_000, help="datagrams a second")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--as", dest="whom", default="stranger",
                        choices=WHOM)  # fmt: skip
    parser.add_argument("--sides", nargs="+", default=("plain", "sealed"))
    parser.add_argument("--group", action="store_true", help="nodes in a multicast group")
    parser.add_argument("--engine", default="python")
    parser.add_argument("--realtime", action="store_true", help="before other work (as root)")
    args = parser.parse_args()
    if args.realtime:
        os.sched_setscheduler(0, os.SCHED_FIFO, os.sched_param(20))
    wrong = []
    for side in args.sides:
        with tempfile.TemporaryDirectory() as folder, (Path(folder) / "log").open("w+") as log:
            wrong += [f"{side}: {text}" for text in run(side, args, folder, log)]
            log.seek(0)
            wrong += [f"{side}: {text.rstrip()}" for text in log]
    for text in wrong:
        print(text)
    sys.exit(bool(wrong))


if __name__ == "__main__":
    main()
