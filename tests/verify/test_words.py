"""What options of an exploration say, at their edges, and what is said of what came of it."""

from dataclasses import dataclass
from types import SimpleNamespace

import pytest

from innervate.dialect.arith import HALF30
from innervate.verify import telling, values
from innervate.verify.cases import (
    BUDGET_MAX,
    Case,
    Story,
    budget_of,
    bytes_of,
    choices,
    extent,
    lines_of,
    verdict,
)
from innervate.verify.errors import VerifyError
from innervate.verify.states import Budget, Node, State, Step
from innervate.verify.tally import Tally


def case(**of):
    return Case([], {}, **{"is_broken": False, **of})


ODD = case(but="but for draws")
WHOLE, PART, BROKEN = case(), case(is_complete=False), case(is_broken=True, is_complete=False)


@pytest.mark.parametrize(
    ("done", "said"),
    [
        ([WHOLE], "Nothing broken in one exploration, completely."),
        ([PART], "Nothing broken in one exploration, only in part."),
        ([BROKEN], "1 of 1 broken."),
        ([WHOLE, WHOLE], "Nothing broken in 2 explorations, all completely."),
        ([WHOLE, PART, PART], "Nothing broken in 3 explorations; 2 of them only in part."),
        ([PART, BROKEN, WHOLE, BROKEN], "2 of 4 broken; 1 of the others only in part."),
        ([WHOLE, BROKEN], "1 of 2 broken."),
        ([ODD], "Nothing broken in one exploration, completely, but for draws."),
        ([ODD, ODD], "Nothing broken in 2 explorations, all completely, but for draws."),
        (
            [ODD, WHOLE],
            "Nothing broken in 2 explorations, all completely, 1 of them but for draws.",
        ),
        (
            [ODD, WHOLE, PART],
            "Nothing broken in 3 explorations; 1 of them only in part, "
            "1 of the others but for draws.",
        ),
        (
            [case(is_complete=False, but="but for draws")],
            "Nothing broken in one exploration, only in part.",
        ),
        ([WHOLE, case(sums_up=False)], ""),
        ([], "Nothing was explored."),
    ],
)
def test_the_last_line_says_what_came_of_all(done, said):
    assert verdict(done) == said
    if "broken" in said:
        assert verdict(done, True) == f"{said[:-1]}; interrupted before the others."


@pytest.mark.parametrize(
    ("ended", "said"),
    [
        ("complete", "all states"), ("broken", "broken"), ("walked", "a sample of random walks"),
        ("memory", "first 1,234 states, to 9 events: memory is full"),
        ("limit", "first 1,234 states, to 9 events, as asked"),
        ("interrupted", "first 1,234 states, to 9 events: interrupted"),
    ],
)  # fmt: skip
def test_how_far_a_search_came(ended, said):
    assert extent(Tally(states=5000, expanded=1234, depth=9, ended=ended)) == said


def test_how_many_a_second():
    assert Tally().per_s == 0
    assert Tally(generated=500, expanded=3, wall_s=0.25).per_s == 2000


def test_a_story_is_numbered_and_says_what_is_broken():
    story = Story("two gateways", ["First.", "Second."])
    assert story.lines() == ["1. First.", "2. Second.", "So: two gateways"]
    head = [
        "pair  BROKEN after 2 events",
        "    1. First.",
        "    2. Second.",
        "    So: two gateways",
    ]
    assert lines_of("pair", story, lambda: "none") == head
    assert lines_of("pair", None, lambda: "all states") == ["pair  all states"]


@dataclass(frozen=True)
class Some:
    loss: int = 1
    ticks: int = 2


@pytest.mark.parametrize(
    ("text", "loss", "ticks"),
    [("", 1, 2), ("loss=0", 0, 2), (f"ticks={BUDGET_MAX}", 1, 20), ("loss=3,ticks=4", 3, 4),
     ("loss=3 ticks=4,", 3, 4), ("ticks=any", 1, 255), ("loss=5,loss=6", 6, 2)],
)  # fmt: skip
def test_budgets_are_changed_by_name(text, loss, ticks):
    assert budget_of(text, Some(), {"ticks=any": ("ticks", 255)}) == Some(loss, ticks)


@pytest.mark.parametrize(
    "text", [f"loss={BUDGET_MAX + 1}", "loss=-1", "loss", "loss=", "los=1", "loss=1.0", "loss=any",
             "loss=\u00b2"],
)  # fmt: skip
def test_what_is_no_budget_is_told_with_all_their_names(text):
    with pytest.raises(VerifyError, match=r"at most 20, or ticks=any; the names are loss, ticks"):
        budget_of(text, Some(), {"ticks=any": ("ticks", 255)})
    with pytest.raises(VerifyError, match="at most 20; the names are loss, restart, input"):
        budget_of("x=1", Budget())


def test_one_of_several_words_or_all():
    assert choices("rule", "all", ("a", "b")) == ("a", "b")
    assert choices("rule", "b", ("a", "b")) == ("b",)
    with pytest.raises(VerifyError, match='--rule is a, b or all, not "c"'):
        choices("rule", "c", ("a", "b"))


@pytest.mark.parametrize(("text", "size"), [("1M", 1 << 20), ("800m", 800 << 20), ("4G", 4 << 30)])
def test_memory(text, size):
    assert bytes_of(text) == size


@pytest.mark.parametrize("text", ["", "G", "0M", "-1M", "4", "4K", "1.5G", "4 G", "4GM"])
def test_what_is_no_memory(text):
    with pytest.raises(VerifyError, match="--memory takes a size like 800M or 4G"):
        bytes_of(text)


DECLARED = (("a", 0, 0, 9), ("many", 2, 0, 9), ("due_us", 0, 0, 9), ("rng", 0, 0, 9))
LABELS = SimpleNamespace(label=lambda number: f"n{number}")
NET = SimpleNamespace(graph=LABELS, fields=SimpleNamespace(STATE=DECLARED), clocks={"due_us"})


def state(*rows):
    return State(tuple(Node(row, ()) for row in rows), (), ())


REST = (0, (1, 2), 3, 4)


def test_a_step_is_told_with_the_fields_it_changed_and_of_whom():
    first = state(REST, REST)
    second = state((5, (1, 2), 99, 77), REST)  # a moment and a draw pass by themselves
    third = state((5, (1, 2), 99, 77), (0, (6, 2), 3, 4))
    before = {first: None, second: (first, "n0 starts"), third: (second, "a hello reaches n1")}
    told = telling.story_of(NET, before, third, "broken")
    assert told.title == "broken"
    assert told.sentences == ["n0 starts: a 0 to 5.", "a hello reaches n1: many[0] 1 to 6."]
    last = Step("n1 breaks", third, "broken")
    told = telling.story_of(NET, before, third, "broken", last)
    assert told.sentences[2:] == ["n1 breaks."]
    assert telling.story_of(NET, before, second, "x", Step("beat", third, "")).sentences == [
        "n0 starts: a 0 to 5.", "beat: n1 many[0] 1 to 6.",
    ]  # fmt: skip


@pytest.mark.parametrize("count", [telling.MOST, telling.MOST + 1, telling.MOST + 5])
def test_a_sentence_has_room_for_so_many_changes(count):
    fields = tuple((f"f{k}", 0, 0, 9) for k in range(count))
    net = SimpleNamespace(graph=LABELS, fields=SimpleNamespace(STATE=fields), clocks=set())
    first, second = state((0,) * count), state((1,) * count)
    (said,) = telling.story_of(
        net, {first: None, second: (first, "n0 beats")}, second, ""
    ).sentences
    assert said.count(" 0 to 1") == telling.MOST
    more = count - telling.MOST
    assert said.endswith(f", {more} more." if more else "f5 0 to 1.")


def test_where_a_protocol_is_wrong():
    def wrong():
        raise ZeroDivisionError("division by zero")

    with pytest.raises(ZeroDivisionError) as found:
        wrong()
    line = wrong.__code__.co_firstlineno + 1
    assert telling.where(found.value).endswith(
        f"test_words.py:{line}: ZeroDivisionError: division by zero"
    )
    record = SimpleNamespace()
    with pytest.raises(AttributeError) as missing:
        record.valu  # noqa: B018
    assert telling.where(missing.value).endswith("valu is no field that fields.py declares")


def test_a_record_as_numbers_and_back():
    record = SimpleNamespace(a=1, many=[2, 3], due_us=4, rng=5)
    row = values.values(record, DECLARED, ("rng",))
    assert row == (1, (2, 3), 4, 0)
    other = SimpleNamespace()
    values.put(other, DECLARED, row)
    assert vars(other) == {"a": 1, "many": [2, 3], "due_us": 4, "rng": 0}
    assert [values.with_one(row, place, "x")[place] for place in range(4)] == ["x"] * 4
    assert values.with_one(row, 1, "x") == (1, "x", 4, 0)


@pytest.mark.parametrize(
    ("at", "found"),
    [(0, 0), (1, 1), (HALF30 - 1, HALF30 - 1), (HALF30, -HALF30), (2 * HALF30 - 1, -1),
     (2 * HALF30, 0), (-1, -1), (-HALF30, -HALF30)],
)  # fmt: skip
def test_moments_ahead_and_behind_on_a_clock_of_30_bits(at, found):
    assert values.ahead(at) == found
