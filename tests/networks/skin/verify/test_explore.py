import pytest

from innervate.networks.skin.verify import graphs
from innervate.networks.skin.verify.command import TICKS
from innervate.networks.skin.verify.system import Budget, SkinModel, system_of
from innervate.verify import explore, search, table
from innervate.verify.cases import budget_of
from innervate.verify.errors import VerifyError
from tests.networks.skin.verify.bench import parents_of

SMALL = Budget(ticks=2, counts=2, faults=1)


def model(graph, **keys):
    return SkinModel(graphs.parse(graph), **{"budget": SMALL} | keys)


CASES = {
    "two in a line": model("pc-1 1-2"),
    "no merging": model("pc-1", merge=False),
    "triggered": model("pc-1", updates="triggered"),
    "pair, paper rule": model("pair", rule="paper", budget=Budget(ticks=2, faults=2)),
    "triangle": model("triangle", budget=Budget(ticks=2, faults=0)),
    "star, strict": model("star", rule="strict", budget=Budget(ticks=2, faults=0)),
    "prompt": model("pc-1 1-2", prompt=True),
}


@pytest.mark.parametrize("name", CASES)
def test_compiled_and_plain_find_the_same(name):
    one, other = (explore.explore(CASES[name], plain=plain) for plain in (False, True))
    assert one.tally.states == other.tally.states > 100
    for number in ("expanded", "generated", "depth", "ended", "left_out"):
        assert getattr(one.tally, number) == getattr(other.tally, number), number
    assert (one.broken, one.path) == (other.broken, other.path)
    assert bytes(memoryview(one.rows).cast("B")) == bytes(other.rows.cast("B"))


def test_a_search_grows_its_table_and_loses_nothing(monkeypatch):
    made = model("triangle", budget=Budget(faults=1))
    roomy = explore.explore(made)
    monkeypatch.setattr(table, "SLOTS", 1 << 15)
    grown = explore.explore(made)
    assert grown.tally.states == roomy.tally.states > 1 << 15
    assert grown.tally.generated == roomy.tally.generated
    assert (grown.rows == roomy.rows).all()


def test_a_small_table_grows_as_often_as_it_must(monkeypatch):
    """It is doubled before the states and one's successors fill seven tenths of it."""
    made = CASES["two in a line"]
    roomy = explore.explore(made, plain=True)
    monkeypatch.setattr(table, "SLOTS", 256)
    monkeypatch.setattr(search, "MARGIN", 64)
    driver = explore._Driver(made, made.system(), True, 1 << 24, 0)
    slots = []
    while (status := driver.advance()) in (search.GOING, search.GROW):
        if status == search.GROW:
            driver.known.grow(driver.engine.refill)
            slots.append((int(driver.run[search.SLOTS]), len(driver.known.search.table)))
    count = int(driver.run[search.COUNT])
    assert (status, count) == (search.DONE, roomy.tally.states)
    doubled = [256 << k for k in range(1, 12) if (256 << k - 1) * 7 < 10 * (count + 64)]
    assert slots == [(places, places) for places in doubled]
    assert len(slots) > 1
    words = count * made.layout().width // 8
    assert bytes(driver.known.search.rows[:words]) == bytes(roomy.rows)


@pytest.mark.parametrize("rule", ["feasible", "strict"])
def test_merging_beacons_into_ticks_reaches_the_same_routes(rule):
    # Who has whom as parent, over all states: the same with every order of every delivery.
    keys = {"rule": rule, "symmetric": False, "budget": Budget(2, 1, 0, 1, 0, 0, 0, 1)}
    merged, every = (model("triangle", merge=merge, **keys) for merge in (True, False))
    routes = [parents_of(made, explore.explore(made).rows) for made in (merged, every)]
    assert len(routes[0]) > 10
    assert routes[0] == routes[1]


def test_symmetries_leave_out_mirror_images_only():
    keys = {"budget": Budget(2, 2, faults=0)}
    one, other = (model("star", symmetric=flag, **keys) for flag in (True, False))
    halved, whole = (explore.explore(made) for made in (one, other))
    assert halved.tally.states < 0.7 * whole.tally.states
    assert 2 * halved.tally.states >= whole.tally.states
    mirrored = {(a, c, b) for a, b, c in parents_of(one, halved.rows)}
    assert parents_of(one, halved.rows) | mirrored == parents_of(other, whole.rows)


def test_a_search_ends_where_it_is_told_to_and_says_so(monkeypatch):
    made = model("triangle", budget=Budget(faults=1))
    assert explore.explore(made, states=1000).tally.ended == "limit"
    monkeypatch.setattr(explore, "EVERY_S", 0.0)
    assert explore.explore(made, progress=lambda _: True).tally.ended == "interrupted"
    with pytest.raises(VerifyError, match="at least 64 MB"):
        explore.explore(made, memory=1 << 20)
    full = explore.explore(made, memory=8 << 20).tally
    assert full.ended == "memory"
    assert full.expanded < full.states


@pytest.mark.parametrize("memory", [8 << 20, 64 << 20])
def test_a_state_takes_its_row_a_way_back_and_two_places_that_are_doubled_in_time(memory):
    made = model("triangle")
    driver = explore._Driver(made, made.system(), True, memory, 1 << 30)
    assert driver.run[search.LIMIT] == memory // (made.layout().width + 4 + 2 * 12)


@pytest.mark.slow  # the longest of all in this room; test_finds.py has small walks
def test_walks_find_what_a_search_finds():
    fine = explore.wander(model("triangle", budget=Budget(ticks=6, counts=5, faults=4)), 200)
    assert (fine.broken, fine.tally.ended, fine.tally.states) == (0, "walked", 200)
    loop = explore.wander(model("triangle", rule="paper", budget=Budget(faults=2)), 100_000)
    assert loop.broken
    again = explore.wander(model("triangle", rule="paper", budget=Budget(faults=2)), 100_000)
    assert again.path == loop.path


def test_the_number_of_graphs_is_known():
    counts = [sum(1 for _ in graphs.all_graphs(cells)) for cells in (1, 2, 3, 4)]
    assert counts == [1, 3, 11, 58]


def test_symmetries_keep_cables():
    graph = graphs.parse("complete")
    ends = graphs.symmetries(graph)
    assert len(ends) == 6
    assert ends[0] == list(range(len(graph.peer)))
    for to in ends:
        for end, peer in enumerate(graph.peer):
            assert peer < 0 or graph.peer[to[end]] == to[peer]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("pc-1 2-3", "all of them by cables"),
        ("pc-1 1-x", "is no cable"),
        ("", "joins the PC"),
        ("pc-1 1-2 1-3 1-4 1-5", "more than 4 cables"),
    ],
)
def test_a_graph_that_is_none_is_refused_in_one_line(text, words):
    with pytest.raises(VerifyError, match=words) as told:
        graphs.parse(text)
    assert "\n" not in str(told.value)


def test_budgets_are_read():
    assert budget_of("ticks=4, loss=0", Budget(), TICKS) == Budget(ticks=4, loss=0)
    with pytest.raises(VerifyError, match="should be NAME=NUMBER"):
        budget_of("tick=4", Budget(), TICKS)


def test_a_first_row_holds_the_budgets():
    made = model("pair")
    row = made.first_row(system_of())
    assert len(row) == made.layout().width
    assert row.count(2) >= 2
