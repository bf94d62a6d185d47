"""One node of a line, run as a process: hop_ends.py FILE, or hop_ends.py bare NUMBER PORTS...

Without more it relays, or tells what it hears: after each line on stdin, {"got": count, "late_us":
[...]} since the last. With more it sends to node TO for so many seconds by a plan, a window of
unacknowledged messages ("w64") or so many a second ("r50"), once TO is reachable, and says
{"delivered", "states", "seconds", "cpu_s"}.
"""

import asyncio
import contextlib
import json
import resource
import sys
import time
from collections import Counter
from pathlib import Path

from benchmarks.live.hop_bare import Bare
from innervate.live.build import build
from innervate.live.nodefile import load

READY_S = 30.0
SETTLE_S = 30.0
STAMP_BYTES = 8


def cpu_s():
    """Seconds of CPU that this process has used."""
    used = resource.getrusage(resource.RUSAGE_SELF)
    return used.ru_utime + used.ru_stime


def mib():
    """Most memory that this process had."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


def sent(node):
    """How many frames have left it."""
    return sum(path.counters["sent"] for path in getattr(node, "paths", ()))


def stamped(size):
    """A payload that begins with the time."""
    return time.monotonic_ns().to_bytes(STAMP_BYTES, "big") + bytes(size - STAMP_BYTES)


async def until_reachable(node, to, size):
    """Send one message after the other until one is delivered."""
    end = time.monotonic() + READY_S
    while time.monotonic() < end:
        with contextlib.suppress(TimeoutError):
            if await asyncio.wait_for(node.send_message(to, bytes(size)).wait(), 5) == "delivered":
                return
        await asyncio.sleep(0.1)
    raise TimeoutError(f"{to} cannot be reached within {READY_S} s")


async def by_window(node, to, size, seconds, window):
    """As many as go, `window` of them without their ends known."""
    states, end = Counter(), time.monotonic() + seconds

    async def one_after_the_other():
        while time.monotonic() < end:
            states[await node.send_message(to, stamped(size)).wait()] += 1

    await asyncio.gather(*(one_after_the_other() for _ in range(window)))
    return states


async def by_rate(node, to, size, seconds, rate):
    """So many a second, on time, whatever becomes of them."""
    loop, receipts = asyncio.get_running_loop(), []
    began = loop.time()
    for k in range(round(seconds * rate)):
        await asyncio.sleep(max(0, began + k / rate - loop.time()))
        receipts.append(node.send_message(to, stamped(size)))
    waiting = [asyncio.ensure_future(receipt.wait()) for receipt in receipts]
    await asyncio.wait(waiting, timeout=SETTLE_S)
    return Counter(receipt.state for receipt in receipts)


async def send(node, to, size, seconds, plan):
    await until_reachable(node, to, size)
    began, cpu = time.monotonic(), cpu_s()
    run = {"w": by_window, "r": by_rate}[plan[0]]
    states = await run(node, to, size, seconds, int(plan[1:]))
    return {"delivered": states["delivered"], "states": states,
            "seconds": time.monotonic() - began, "cpu_s": cpu_s() - cpu}  # fmt: skip


async def main():
    path, *words = sys.argv[1:]
    if path == "bare":
        node = Bare(int(words[0]), [int(word) for word in words[1:]])
    else:
        node = build(load(Path(path)))
    late_us, cpu = [], cpu_s()

    def hear(_sender, payload):
        stamp = int.from_bytes(payload[:STAMP_BYTES], "big")
        if stamp:
            late_us.append((time.monotonic_ns() - stamp) / 1000)

    node.receive_messages(hear)
    await node.start()
    print(json.dumps({"ready": node.name}), flush=True)
    loop = asyncio.get_running_loop()
    reader = asyncio.StreamReader()
    await loop.connect_read_pipe(lambda: asyncio.StreamReaderProtocol(reader), sys.stdin)
    while line := await reader.readline():
        words = line.decode().split()
        if words[0] == "send":
            told = await send(node, int(words[1]), int(words[2]), float(words[3]), words[4])
        else:
            told = {"got": len(late_us), "late_us": late_us[:], "cpu_s": cpu_s() - cpu,
                    "counters": node.counters(), "sent": sent(node), "mib": mib()}  # fmt: skip
            late_us.clear()
            cpu = cpu_s()
        print(json.dumps(told), flush=True)
    await node.stop()


if __name__ == "__main__":
    asyncio.run(main())
