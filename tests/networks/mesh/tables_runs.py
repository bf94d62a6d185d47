"""A mesh that has everything a report shows, for tests of the rooms above the simulator."""

FENCE = {
    "polygon": [[0, 0], [100, 0], [100, 100], [50, 85], [0, 100]],
    "holes": [[[40, 40], [60, 40], [60, 60], [40, 60]]],
}
ROBOTS = [
    {"node": 29, "waypoints": [[80, 50], [104, 50], [80, 50]], "speed_mps": 2, "start_s": 8},
    {"node": 28, "waypoints": [[20, 86], [20, 104], [20, 80]], "speed_mps": 1, "start_s": 8},
]


def mesh_tables(**changes):
    """Scenario tables: 32 nodes, two robots that leave the fence, six nodes that die before."""
    return {
        "kind": "mesh",
        "name": "<field> & more",
        "duration_s": 30.0,
        "seed": 3,
        "nodes": 32,
        "standby": [7],
        "monitor": 5,
        "flow": [
            {"from": "all", "to": "monitor", "every_s": 4, "jitter_s": 4},
            {"from": 1, "to": 2, "every_s": 1},
        ],
        "fence": FENCE,
        "robot": ROBOTS,
        "event": [{"at_s": 15, "action": "kill", "random": 6}],
    } | changes


def without_fence(**changes):
    """The same nodes without robots and a fence."""
    made = mesh_tables(name="plain", duration_s=6.0, event=[], **changes)
    return {name: value for name, value in made.items() if name not in ("fence", "robot")}
