"""python -m tests.livesim: seed after seed, until told to stop or something is broken."""

import argparse
import sys
import time

from tests.livesim import runs


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
    seed = args.first if args.seed is None else args.seed
    began, simulated, failures = time.process_time(), 0.0, 0
    while True:
        found = runs.run(seed, args.kind)
        simulated += found.seconds
        for line in found.broken[:3]:
            kind = f" --kind {args.kind}" if args.kind else ""
            print(f"seed {seed} ({found.what}): {line}", flush=True)
            print(f"  again: python -m tests.livesim --seed {seed}{kind}", flush=True)
        failures += bool(found.broken)
        cpu_s = time.process_time() - began
        if args.seed is not None:
            print(f"{found.what}: {found.told}")
        enough = args.cpu_minutes is not None and cpu_s > 60 * args.cpu_minutes
        seed += 1
        if args.seed is not None or enough or simulated >= 3600 * args.hours:
            break
        if failures and not args.on:
            break
    rate = simulated / max(cpu_s, 1e-9)
    print(f"{simulated / 3600:.2f} simulated hours, {cpu_s:.0f} s of CPU ({rate:.0f} to 1), "
          f"{failures} seeds broken")  # fmt: skip
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
