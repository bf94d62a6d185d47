"""What is said of events of a skin and of the answer to how large it has to be."""

from types import SimpleNamespace as Of

import polars as pl
import pytest

from innervate.networks.skin.plot import answer, words
from innervate.scenario.actions.cables import CUT, KILL, LOOSE, LOSE, RESTART, RESTORE, REVIVE
from innervate.scenario.cables import LOSS_ONE, Fault
from innervate.topology.weak import Weak
from tests.networks.skin.runs import line, plan_of

# pc.0 - c0 - c1 - c2 - pc.1; end = 4 * cell + port, W 0, E 1; pc.0 is end 12.
GRAPH = plan_of(line(3)).graph
CABLE = "cable p0 r0 c0 E - p0 r0 c1 W"


def fault(action, end=1, node=-1, loss=0.0, frames=0):
    return Fault(at_us=9, action=action, end=end, node=node, loss_q15=round(loss * LOSS_ONE),
                 frames=frames, index=0)  # fmt: skip


@pytest.mark.parametrize(("given", "said"), [
    (fault(CUT), f"{CABLE} cut"), (fault(CUT, 4), "cable p0 r0 c1 W - p0 r0 c0 E cut"),
    (fault(CUT, 0), "cable to interface 0 cut"), (fault(RESTORE, 13),
                                                  "cable to interface 1 put back"),
    (fault(LOOSE, loss=0.25), f"{CABLE} loose, losing 25 %"),
    (fault(LOOSE), f"{CABLE} tight again"),
    (fault(LOSE, frames=1), f"{CABLE} loses 1 frame"), (fault(LOSE, frames=3),
                                                        f"{CABLE} loses 3 frames"),
    (fault(KILL, -1, 2), "cell p0 r0 c2 switched off"), (fault(REVIVE, -1, 0),
                                                         "cell p0 r0 c0 switched on again"),
    (fault(RESTART, -1, 1), "cell p0 r0 c1 restarted"), (fault(RESTART, -1, GRAPH.sink),
                                                         "the PC restarted"),
])  # fmt: skip
def test_an_event_in_words(given, said):
    assert words.fault_words(GRAPH, given) == said


CALM = {"detected_ms": None, "routed_ms": 0.0, "converged_ms": None}
OUTCOMES = [
    ({}, "every cell kept its way to the PC"),
    ({"converged_ms": 12.0}, "every cell kept its way to the PC, the last one changed it after "
                             "12.0 ms"),
    ({"detected_ms": 8.0, "routed_ms": 20.0}, "noticed after 8 ms, every cell had a way again "
                                              "after 20.0 ms"),
    ({"routed_ms": 20.0, "others_ms": 30.0}, "every cell had a way again after 30.0 ms"),
    ({"routed_ms": 20.0, "action": "kill"}, "every other cell had a way again after 20.0 ms"),
    ({"routed_ms": 20.0, "cut_off": 1, "cut_off_total": 1},
     "1 cell was cut off, as no cable joined it with the PC any more, every other cell had a way "
     "again after 20.0 ms"),
    ({"routed_ms": 20.0, "cut_off": 2, "cut_off_total": 5},
     "2 cells were cut off, as no cable joined them with the PC any more, every other cell had a "
     "way again after 20.0 ms, 3 cells stayed cut off"),
    ({"routed_ms": None}, "some cells still had no way to the PC by the next event or the end"),
    ({"routed_ms": None, "without_way": 0}, "no cell was on any more"),
    ({"routed_ms": None, "without_way": 1},
     "1 cell still had no way to the PC by the next event or the end"),
    ({"routed_ms": None, "cut_off": 3, "cut_off_total": 3},
     "3 cells were cut off, as no cable joined them with the PC any more"),
    ({"routed_ms": None, "cut_off": 3, "cut_off_total": 3, "without_way": 2},
     "3 cells were cut off, as no cable joined them with the PC any more, 2 cells still had no way "
     "to the PC by the next event or the end"),
]  # fmt: skip


@pytest.mark.parametrize(("recovery", "said"), OUTCOMES)
def test_what_came_of_an_event(recovery, said):
    assert words.outcome(CALM | recovery) == said


def test_what_is_still_so_may_be_said_otherwise_and_a_headline_is_a_sentence():
    lost = CALM | {"routed_ms": None, "at_s": 0.25}
    assert words.outcome(lost, "2 cells had none") == "2 cells had none"
    assert words.headline(GRAPH, fault(CUT, 0), lost, "2 cells had none") == (
        "Cable to interface 0 cut at 0.250 s: 2 cells had none."
    )


def test_a_broken_cable_is_told_once_since_whoever_noticed_first():
    def port(cell, name, to=None, since_s=None):
        return {"cell": cell, "port": name, "to": to, "since_s": since_s}

    assert words.broken_cables([
        port("n1", "E", "n2 W", 2.0), port("n2", "W", "n1 E", 1.5), port("n3", "E", "pc.1", 4.0),
        port("n4", "N"), port("n5", "E", "n6 W"), port("n6", "W", "n5 E", 3.0),
    ]) == [
        "cable n1 E - n2 W, since 1.500 s", "cable from interface 1 to n3 E, since 4.000 s",
        "cable at n4 N", "cable n5 E - n6 W, since 3.000 s",
    ]  # fmt: skip


ROW = {"rate_hz": 250.0, "ports": 1, "isolated_max": 2, "enough": False, "unhealed": 0}
SPANS = {"loss_cell": (0.01, 0.006, 0.014), "recovery_ms_cell": (20.0, 18.0, 22.0),
         "recovery_ms_pc": (None, None, None)}  # fmt: skip


def answer_of(needed, carries, weak=(), rows=1):
    columns = dict(ROW)
    for name, values in SPANS.items():
        parts = zip(("mean", "low", "high"), values, strict=True)
        columns |= {f"{name}_{part}": value for part, value in parts} | {f"{name}_runs": 20}
    made = [columns | more for more in (
        {}, {"ports": 2, "isolated_max": 0, "enough": True}, {"ports": 3, "isolated_max": 1},
        {"isolated_max": None},
    )]  # fmt: skip
    asked = Of(pitch_mm=28.0, reach_mm=60.0, loss_max=0.02, recovery_ms_max=50.0, ports=(1, 2, 3))
    return Of(question=asked, frames=None, cells=3, needed=needed, carries=carries, is_single=False,
              table=pl.DataFrame(made[:rows]), where={1: ["n1 W"], 2: ["n1 W", "n3 E"]},
              graphs={1: GRAPH, 2: GRAPH}, weak={1: list(weak), 2: []})  # fmt: skip


def test_a_table_of_what_every_number_of_ports_gives():
    lines = answer._table(answer_of({}, {}, rows=4))
    assert lines[0] == "3 cells 28 mm apart, cables of at most 60 mm"
    cells = [[part for part in row.split("  ") if part] for row in lines[3:]]
    for row, (ports, gone, enough) in zip(cells, ((1, "up to 2 cells", "no"), (2, "nobody", "yes"),
                                                  (3, "up to 1 cell", "no"), (1, "-", "no")),
                                          strict=True):  # fmt: skip
        words_ = [part.strip() for part in row]
        assert words_[-5:] == ["1.00 +- 0.40 %", "20.0 +- 2.0", "-", gone, enough]
        assert words_[0].startswith("250 Hz")
        assert str(ports) in " ".join(words_[:2])


def test_one_run_alone_has_no_interval():
    row = {"loss_cell_mean": 0.01, "loss_cell_low": 0.01, "loss_cell_high": 0.01,
           "loss_cell_runs": 1}  # fmt: skip
    assert answer._interval(row, "loss_cell", 100, 2, " %") == "1.00 %"
    assert (
        answer._interval(row | {"loss_cell_runs": 2}, "loss_cell", 100, 2, " %") == "1.00 +- 0.00 %"
    )


@pytest.mark.parametrize(("ports", "said"), [
    ((1,), "up to 1 port"),
    ((1, 2, 3), "up to 3 ports"),
    ((2,), "the numbers of ports that were tried (2)"),
    ((1, 100), "the numbers of ports that were tried (1, 100)"),
    (tuple(range(2, 12)), "the numbers of ports that were tried (2, 3, 4, 5, ..., 11)"),
])  # fmt: skip
def test_only_what_was_tried_is_said_not_to_be_enough(ports, said):
    assert answer._tried(ports) == said


def test_how_many_ports_every_rate_needs():
    made = answer_of({100.0: 1, 250.0: 2, 500.0: None, 999.0: None},
                     {100.0: 1, 250.0: 2, 500.0: 2, 999.0: None})  # fmt: skip
    limits = "2 % lost, ways back in 50 ms"
    heals = "and every single failure of a cable or cell heals, on"
    assert answer._verdicts(made) == [
        f"100 Hz: 1 port is enough for {limits}, {heals} n1 W.",
        f"250 Hz: 2 ports are enough for {limits}, {heals} n1 W, n3 E.",
        f"500 Hz: none of up to 3 ports is enough: 2 ports are enough for {limits}, but not every "
        "single failure heals.",
        f"999 Hz: none of up to 3 ports is enough for {limits}.",
    ]


@pytest.mark.parametrize(("count", "said"), [
    (1, "With 1 port 1 single failure cuts off cells for good: cell p0 r0 c0 (1 cell)."),
    (4, "With 1 port 4 single failures cut off cells for good: "),
    (6, "cable p0 r0 c0 E - p0 r0 c1 W (2 cells), and 2 more."),
])  # fmt: skip
def test_who_isolates_whom(count, said):
    weak = [Weak(node=0, end=-1, isolated=1)] + [Weak(node=-1, end=1, isolated=2)] * (count - 1)
    line_, last = answer._unhealed(answer_of({}, {9.0: 1, 8.0: None}, weak))
    assert said in line_
    assert ("more" in line_) == (count > 4)
    assert last.startswith("Longer cables")
    assert answer._unhealed(answer_of({}, {9.0: 2, 8.0: None}, weak)) == []
