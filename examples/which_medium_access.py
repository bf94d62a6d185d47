"""Which medium access protocol fits a robot team whose radios take 2 ms to switch?

Every robot always has something to send; printed is how much of the channel's time packets fill,
and Jain's index of fairness over one round, 1 = every robot once.
Run it with: python examples/which_medium_access.py
"""

import innervate

MACS = ("csma-cd-r", "csma-cd-d2", "csma-cd-d2p", "dcf", "tdma")
ROBOTS = (2, 5, 10, 20)


def share(mac: str, robots: int) -> str:
    """Throughput in %, and fairness."""
    run = innervate.run(
        {
            "kind": "radio",
            "stations": robots,
            "packet_slots": 25,
            "traffic": {"kind": "saturated", "packets": 60},
            "channel": {"turnaround_us": 2000},
            "protocol": {"mac": mac, "backoff_slots": 11},
        }
    )
    return f"{100 * run.summary['throughput']:5.1f} %  {run.summary['jain_round']:.2f}"


if __name__ == "__main__":
    print(f"{'robots':>6}  " + "".join(f"{mac:>16}" for mac in MACS))
    for robots in ROBOTS:
        print(f"{robots:>6}  " + "".join(f"{share(mac, robots):>16}" for mac in MACS), flush=True)
