"""Does my field need a standby or more posts? Alarms against dead nodes, for four ways to forward.

Four robots leave a fenced field of 100 m one after another while some of its posts are dead, which
nobody knows. Printed is the share of the crossings that the monitor learned of within 0.1 s, and
how long 90 % of the alarms took. In the last lines the gateway has died, which is the monitor too.
Run it with: python examples/standby_or_posts.py [seeds]
"""

import sys

import matplotlib.pyplot as plt
import polars as pl

import innervate

RULES = {
    "by the letter": {
        "protocol": {"failover": "random", "retry": False, "reliable": False, "transmissions": 1},
        "fence": {"flood": "never"},
    },
    "search, no flood": {"fence": {"flood": "never"}},
    "search": {},
    "graph": {"protocol": {"failover": "graph"}},
}
DEAD = (0, 4, 8)
POSTS = (20, 28)
ENDS = ([50, 105], [105, 50], [50, -5], [-5, 50])  # where the robots go from the middle
DIES_S = 14.0
IN_TIME_MS = 100
PICTURE = "standby_or_posts.png"


def field(posts, rule, dead, *, standby=False, gateway_dies=False):
    """The scenario; with a dead gateway the robots wait until a standby can have taken over."""
    fence = {"polygon": [[0, 0], [100, 0], [100, 100], [0, 100]]}
    starts_s = 50.0 if gateway_dies else DIES_S + 0.5
    made = {
        "kind": "mesh",
        "duration_s": starts_s + 16,
        "nodes": posts + len(ENDS),
        "standby": [1] if standby else [],
        "radio": {"reach_m": 32},  # the same radios, however many
        "fence": fence | rule.get("fence", {}),
        "protocol": rule.get("protocol", {}),
        "robot": [
            {"node": posts + i, "waypoints": [[50, 50], end], "speed_mps": 5, "start_s": starts_s}
            for i, end in enumerate(ENDS)
        ],
        "event": [],
    }
    for i, robot in enumerate(made["robot"]):
        robot["start_s"] += i  # one alarm at a time
    if dead:
        made["event"].append({"at_s": DIES_S, "action": "kill", "random": dead})
    if gateway_dies:
        made["event"].append({"at_s": DIES_S, "action": "kill", "node": "gateway"})
    return made


def alarms(seeds, *args, **options):
    """(share that came in time, ms that 90 % took, None = more never came) over many seeds."""
    found = pl.concat(
        innervate.run(field(*args, **options), seed=seed).tables["crossings"].collect()
        for seed in range(1, seeds + 1)
    )
    took = sorted((found["accepted_us"] - found["raised_us"]).drop_nulls() / 1000)
    place = -(-9 * len(found) // 10) - 1
    in_time = sum(ms <= IN_TIME_MS for ms in took) / len(found)
    return in_time, took[place] if place < len(took) else None


def shown(share, ms):
    """A cell of the table."""
    return f"{100 * share:.0f} %" + (", -" if ms is None else f", {ms:,.0f} ms")


def draw(figures):
    """Delivery and latency against dead nodes; dashed: fewer posts."""
    figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.6), layout="constrained")
    for (posts, rule), cells in figures.items():
        look = {"color": f"C{list(RULES).index(rule)}", "ls": "--" if posts == POSTS[0] else "-",
                "marker": "o", "label": f"{rule}, {posts} posts"}  # fmt: skip
        left.plot(DEAD, [100 * share for share, _ms in cells], **look)
        right.plot(DEAD, [float("nan") if ms is None else ms for _share, ms in cells], **look)
    left.set(xlabel="dead posts", ylabel="alarms within 0.1 s, %", ylim=(0, 104))
    right.set(xlabel="dead posts", ylabel="90 % of the alarms within, ms", yscale="log")
    right.legend(fontsize=7, loc="center left", bbox_to_anchor=(1, 0.5), frameon=False)
    figure.savefig(PICTURE, dpi=150)


def main(seeds):
    """Print one table for each number of posts, and draw both."""
    figures = {}
    for posts in POSTS:
        print(f"{posts} posts" + "".join(f"{rule:>19}" for rule in RULES))
        for dead in DEAD:
            cells = [alarms(seeds, posts, rule, dead) for rule in RULES.values()]
            for rule, cell in zip(RULES, cells, strict=True):
                figures.setdefault((posts, rule), []).append(cell)
            print(f"{dead:>3} dead" + "".join(f"{shown(*c):>19}" for c in cells), flush=True)
        for standby in (False, True):
            cell = alarms(seeds, posts, {}, 0, standby=standby, gateway_dies=True)
            name = "with one" if standby else "without a"
            print(f"gateway dead, {name} standby: {shown(*cell)}", flush=True)
    draw(figures)
    print(f"drawn: {PICTURE}")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 8)
