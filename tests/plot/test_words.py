import pytest

from innervate.networks.skin.plot import words as skin_words
from innervate.plot import page, words


@pytest.mark.parametrize(
    ("value", "text"),
    [(0.183, "0.183 ms"), (8.4321, "8.43 ms"), (17.011, "17.0 ms"), (1443.03, "1.44 s")],
)
def test_times(value, text):
    assert words.ms_words(value) == words.stood_words(value) == text


def test_what_stood_did_not_stand_for_nothing():
    assert words.stood_words(0.0) == "less than 0.001 ms"


@pytest.mark.parametrize(
    ("wall_s", "text"), [(0.0004, "less than 0.01 s"), (0.01, "0.01 s"), (12.345, "12.35 s")]
)
def test_what_was_quick_took_some_time(wall_s, text):
    assert words.wall_words(wall_s) == text


@pytest.mark.parametrize(
    ("value", "text"), [(0.5, "0.5"), (12.0, "12"), (12000, "12,000"), (3_077_159, "3.077 M")]
)
def test_counts(value, text):
    assert words.count_words(value) == text


def test_shares():
    assert words.share_words(0.00653) == "0.653 %"
    assert words.share_words(1e-7) == "less than 0.001 %"
    assert words.share_words(0) == "0 %"
    assert words.ms_words(1_234_500) == "1,234 s"


def test_every_kind_of_event_has_words(many):
    graph = many.plan.graph
    found = [skin_words.fault_words(graph, fault) for fault in many.plan.faults]
    assert found[0] == "cable to interface 1 cut"
    assert found[1] == "cell p0 r2 c2 switched off"
    assert found[2].startswith("cable p0 r")
    assert found[3] == "cable to interface 1 put back"
    assert found[4] == "cell p0 r2 c2 switched on again"
    assert found[5] == "cell p0 r3 c1 restarted"
    assert found[6].endswith("loose, losing 40 %")
    assert found[7] == "the PC restarted"
    assert found[8] == "cable to interface 0 loses 2 frames"


def test_headline(cut):
    recovery = cut.summary["recoveries"][0]
    sentence = skin_words.headline(cut.plan.graph, cut.plan.faults[0], recovery)
    detected, routed = (words.ms_words(recovery[k]) for k in ("detected_ms", "routed_ms"))
    assert sentence == (
        f"Cable to interface 1 cut at 0.300 s: noticed after {detected}, "
        f"every cell had a way again after {routed}."
    )


def test_outcomes():
    never = {"detected_ms": None, "routed_ms": None, "converged_ms": None}
    assert "still had no way" in skin_words.outcome(never)
    assert skin_words.outcome(never, "3 cells are lost") == "3 cells are lost"
    kept = {"detected_ms": None, "routed_ms": 0.0, "converged_ms": 18.5}
    assert skin_words.outcome(kept) == (
        "every cell kept its way to the PC, the last one changed it after 18.5 ms"
    )


def recovery(**keys):
    """What followed a cut that harmed nobody, with some changes."""
    found = {"action": "cut", "detected_ms": None, "converged_ms": None, "routed_ms": 0.0}
    found |= {"others_ms": 0.0, "without_way": 0, "cut_off": 0, "cut_off_total": 0}
    return found | keys


@pytest.mark.parametrize(("changes", "said"), [
    ({}, "every cell kept its way to the PC"),
    ({"routed_ms": None, "others_ms": None, "cut_off": 9, "cut_off_total": 9},
     "9 cells were cut off, as no cable joined them with the PC any more"),
    ({"routed_ms": None, "cut_off": 1, "cut_off_total": 1},
     "1 cell was cut off, as no cable joined it with the PC any more, "
     "every other cell kept its way to the PC"),
    ({"routed_ms": None, "others_ms": 17.0, "cut_off": 2, "cut_off_total": 5},
     "2 cells were cut off, as no cable joined them with the PC any more, "
     "every other cell had a way again after 17.0 ms, 3 cells stayed cut off"),
    ({"routed_ms": None, "others_ms": None, "without_way": 4},
     "4 cells still had no way to the PC by the next event or the end"),
    ({"action": "kill"}, "every other cell kept its way to the PC"),
])  # fmt: skip
def test_cells_that_are_cut_off_are_told_from_those_with_a_way(changes, said):
    assert skin_words.outcome(recovery(**changes)) == said


def test_a_broken_cable_is_named_once():
    both = [
        {"cell": "p0 r0 c0", "port": "E", "since_s": 1.5, "to": "p0 r0 c1 W"},
        {"cell": "p0 r0 c1", "port": "W", "since_s": 1.25, "to": "p0 r0 c0 E"},
        {"cell": "p0 r5 c3", "port": "down", "since_s": None, "to": "pc.1"},
    ]
    assert skin_words.broken_cables(both) == [
        "cable p0 r0 c0 E - p0 r0 c1 W, since 1.250 s",
        "cable from interface 1 to p0 r5 c3 down",
    ]
    assert skin_words.broken_cables([]) == []


@pytest.mark.parametrize(("cell", "shown"), [
    ("17.0 ms", "17.0~ms"), ("25.2 (25.1 to 29.7)", "25.2 (25.1~to~29.7)"),
    ("cut: 6.7 (-1.0 to 9,600), less", "cut: 6.7 (-1.0~to~9,600), less"),
    ("as (it is to be)", "as (it is to be)"),
])  # fmt: skip
def test_numbers_stay_with_their_units_and_intervals_whole(cell, shown):
    assert f"<td>{shown}</td>" in page.table(["a"], [[cell]]).replace("\N{NO-BREAK SPACE}", "~")
