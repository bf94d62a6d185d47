"""python -m tests.livesim: seed after seed, until told to stop or something is broken."""

import argparse
import sys
import time
from collections import Counter
from contextlib import suppress

from tests.livesim import runs

TELL_S = 60.0


def main():
    """Run seeds; exit code 1 and the seed to replay where something is broken."""
    parser = argparse.ArgumentParser(prog="python -m tests.livesim", description=__doc__)
    parser.add_argument("--hours", type=float, default=1.0, help="simulated, of all seeds together")
    parser.add_argument("--cpu-minutes", type=float, help="stop after so much CPU time")
    parser.add_argument("--first", type=int, default=1, help="the first seed")
    parser.add_argument("--seed", type=int, help="this seed alone, with what happens in it")
    parser.add_argument("--kind", choices=sorted(runs.KINDS), help="this kind of network alone")
    parser.add_argument("--on", action="store_true", help="go on after a failure")
    args = parser.parse_args()
    tally = Tally()
    with suppress(KeyboardInterrupt):
        run(args, tally)
    print(tally)
    return 1 if tally.broken else 0


class Tally:
    """What was run until now."""

    def __init__(self):
        self.hours = Counter()
        self.seeds = self.broken = 0
        self._began, self._told = time.process_time(), time.monotonic()

    def add(self, kind, found):
        """One more seed; once a minute what came of all is said."""
        self.hours[kind] += found.seconds / 3600
        self.seeds += 1
        self.broken += bool(found.broken)
        if time.monotonic() - self._told > TELL_S:
            self._told = time.monotonic()
            print(self, file=sys.stderr, flush=True)

    def cpu_s(self):
        """Processor time that it took."""
        return time.process_time() - self._began

    def __str__(self):
        hours, cpu_s = self.hours.total(), self.cpu_s()
        kinds = ", ".join(f"{kind} {self.hours[kind]:.1f}" for kind in sorted(self.hours))
        return (f"{hours:.2f} simulated hours ({kinds}), {cpu_s:.0f} s of CPU "
                f"({3600 * hours / max(cpu_s, 1e-9):.0f} to 1), {self.seeds} seeds, "
                f"{self.broken} broken")  # fmt: skip


def run(args, tally):
    """Seed after seed, into the tally."""
    seed = args.first if args.seed is None else args.seed
    while True:
        found = runs.run(seed, args.kind)
        for line in found.broken[:3]:
            kind = f" --kind {args.kind}" if args.kind else ""
            print(f"seed {seed} ({found.what}): {line}", flush=True)
            print(f"  again: python -m tests.livesim --seed {seed}{kind}", flush=True)
        tally.add(args.kind or runs.kind_of(seed), found)
        if args.seed is not None:
            print(f"{found.what}: {found.told}")
            return
        seed += 1
        if tally.hours.total() >= args.hours or (tally.broken and not args.on):
            return
        if args.cpu_minutes is not None and tally.cpu_s() > 60 * args.cpu_minutes:
            return


if __name__ == "__main__":
    sys.exit(main())
