"""What the simulation showed once, by the seeds that did: keys, whatever becomes of files."""

from tests.livesim import runs

SMALL = {"nodes": 6, "storms": 1, "storm_s": 60, "calm_s": 0, "rate": 20}


def broken_in(seeds, **given):
    """What is broken in the first of these seeds in which something is."""
    found = (runs.run(seed, "mesh", **SMALL | given).broken for seed in seeds)
    return next((broken for broken in found if broken), [])


def test_no_nonce_comes_twice_where_the_disk_is_full_and_processes_are_killed():
    given = {"sealed": True, "in_order": False, "hurts": ("full", "restarts")}
    assert [line for line in broken_in((1, 2), **given) if "nonce" in line] == []


def test_nothing_is_taken_from_a_recording_by_a_node_that_was_killed():
    hurts = ("replays", "restarts")
    assert broken_in((1, 2), sealed=True, in_order=False, hurts=hurts, old_lives=True) == []
