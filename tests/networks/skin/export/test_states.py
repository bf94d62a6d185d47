"""What a recording knows of a skin's cells, by hand."""

from types import SimpleNamespace

import polars as pl

from innervate.networks.skin.export.states import States
from innervate.scenario import loads, plan


def test_a_cell_is_known_for_a_tenth_of_a_second_and_no_longer():
    told = SimpleNamespace(heard=[50_000, 50_001, 49_999])
    assert States.known(told, 150_000) == [True, True, False]


LINE = "kind='skin'\nduration_s=0.3\n[[link]]\na='n1'\nb='pc'\n[[link]]\na='n1'\nb='n2'\n"


def test_a_skin_step_by_step():
    made = plan(loads(LINE))
    sample = {"time_us": [50_000], "cell": [1], "proximity": [9]}
    tables = {
        "routes": pl.DataFrame({"time_us": [10_000, 120_000], "cell": [1, 0], "new": [0, 0]}),
        "outages": pl.DataFrame({"time_us": [99_999], "unrouted": [2], "cut_off": [1]}),
        "received": pl.DataFrame(sample | {f"force_{i}": [i * 100] for i in range(3)}),
    }
    first = States(made, tables, 100_000)
    assert (first.parent, first.force, first.proximity) == ([-1, -1], [0, 0], [0, 0])
    assert (first.known(0), first.unrouted, first.cut_off) == ([False, False], 0, 0)
    seen = [
        (at, [*here.force], [*here.proximity], here.known(at), here.hops, here.unrouted)
        for at, here in States(made, tables, 100_000).snapshots()
    ]
    assert seen == [
        (100_000, [0, 100], [0, 9], [False, True], [-1, -1], 2),
        (200_000, [0, 100], [0, 9], [False, False], [1, 2], 2),
        (300_000, [0, 100], [0, 9], [False, False], [1, 2], 2),
    ]
