"""Events per second of a tight C loop with one heap pop and push per event (heap_loop.c)."""

import shutil
import subprocess
import tempfile
from pathlib import Path

SOURCE = Path(__file__).with_name("heap_loop.c")
ARITIES = (2, 4)
FLAGS = ("-O3", "-march=native", "-std=gnu11")


def compiler():
    """The C compiler's path, or None."""
    return next(filter(None, map(shutil.which, ("cc", "gcc", "clang"))), None)


def measure(pending=10_000, seconds=1.0):
    """Events per second at `pending` events; None without a compiler.

    Both heaps, binary and 4-ary, get half of `seconds`; `events_per_s` is the faster one's.
    """
    cc = compiler()
    if cc is None:
        return None
    with tempfile.TemporaryDirectory() as folder:
        program = Path(folder) / "heap_loop"
        subprocess.run([cc, *FLAGS, str(SOURCE), "-o", str(program), "-lm"], check=True)
        rates = {arity: _rate(program, arity, pending, seconds / len(ARITIES)) for arity in ARITIES}
    best = max(rates, key=rates.get)
    return {
        "pending": pending,
        "events_per_s": rates[best],
        "arity": best,
        "by_arity": rates,
        "flags": " ".join(FLAGS),
    }


def _rate(program, arity, pending, seconds):
    command = [str(program), str(arity), str(pending), str(seconds)]
    done = subprocess.run(command, capture_output=True, text=True, check=True)
    return float(done.stdout)


if __name__ == "__main__":
    for pending in (204, 1_000, 10_000, 100_000, 1_000_000):
        print(measure(pending))
