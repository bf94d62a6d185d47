"""What a run says of assumptions that it left: where, of whom, since when."""

import numpy as np

from innervate.networks.skin.analysis.proved import outside
from innervate.networks.skin.sim.proved import HOLD, NUMBERS, ORDER, OUTSIDE, RESTART
from innervate.sim.tables import ROW, row_dtype


def test_each_row_is_a_sentence_that_names_who_it_is_about():
    rows = [(5, 1, OUTSIDE - 1, RESTART, 2), (1_500_000, 1, OUTSIDE, RESTART, 0),
            (2_000_001, 0, OUTSIDE, HOLD, 3), (3_000_000, 2, OUTSIDE, NUMBERS, -1),
            (4_000_000, 0, OUTSIDE, ORDER, 0)]  # fmt: skip
    said = outside(np.array(rows, row_dtype(ROW)), lambda node: f"c{node}")
    since = "outside what is proved from"
    assert said == [
        f"{since} 1.500000 s on: c1, which was restarted, takes a route although c0 has an old one "
        "of it still (Restart)",
        f"{since} 2.000001 s on: c0, which forgot its feasible distance, takes a route although c3 "
        "has an old one of it still (FD_HOLD)",
        f"{since} 3.000000 s on: numbers in use do not lie within half of all, the oldest at c2 "
        "(Numbers)",
        f"{since} 4.000000 s on: under rule strict a beacon from c0 comes to c0 behind a newer one "
        "(Order)",
    ]
