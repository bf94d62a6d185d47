"""How long does a skin take to recover, over many seeds, for three ways of sending beacons?

Seeds change the clocks, the latencies and the choices of cells; the cable is cut at a moment that
is drawn, too. Run it with: python examples/recovery_times.py [seeds]
"""

import statistics
import sys

import innervate

SEEDS = 10


def routed_ms(updates: str, seed: int) -> float:
    """From the cut until every cell had a way to the PC again."""
    changes = {
        "protocol.updates": updates,
        "protocol.k": 3,
        "event.0.at_s": [0.50, 0.51],
        "duration_s": 1.0,
    }
    run = innervate.run("setup-1", seed=seed, overrides=changes)
    time_ms: float = run.summary["recoveries"][0]["routed_ms"]
    return time_ms


def main(seeds: int) -> None:
    """Print a line for each way."""
    print(f"99 cells, 250 Hz, k = 3, {seeds} seeds: ms until every cell has a way again")
    for updates in ("periodic", "triggered", "wave"):
        times = [routed_ms(updates, seed) for seed in range(1, seeds + 1)]
        print(f"  {updates:<10} mean {statistics.mean(times):5.1f}   worst {max(times):5.1f}")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else SEEDS)
