"""Values of a sweep at their edges: texts, formulas, rows of summaries."""

import pytest

from innervate.sweeping import SweepError
from innervate.sweeping import vary as axes
from innervate.sweeping.derive import LENGTH_MAX, Formula
from innervate.sweeping.flat import LIST_MAX, TABLES_MAX, flat
from innervate.sweeping.plan import _look_up
from innervate.sweeping.vary import Named, axis, canonical, column, parse, shown, split, values_of


@pytest.mark.parametrize(("text", "values"), [
    ("1..4", [1, 2, 3, 4]), ("4..1..-1", [4, 3, 2, 1]), ("3..3", [3]), ("1..6..2", [1, 3, 5]),
    ("0..0.3..0.1", [0.0, 0.1, 0.2, 0.3]), ("1.0..2..1", [1.0, 2.0]), ("-1..1", [-1, 0, 1]),
    ("1..9..4", [1, 5, 9]), ("abc", ["abc"]), ("2.5", [2.5]), ("true", [True]),
])  # fmt: skip
def test_a_range_holds_what_it_says(text, values):
    found = values_of(text, "here")
    assert found == values
    assert [type(one) for one in found] == [type(one) for one in values]


@pytest.mark.parametrize(("text", "message"), [
    ("1..4..0", "here: 1..4..0 leads nowhere; write FIRST..LAST..STEP"),
    ("4..1", "here: 4..1 leads nowhere; write FIRST..LAST..STEP"),
    ("1..4..-1", "leads nowhere"),
    ("0..0.5", "here: 0..0.5 needs a step, like 0..0.5..0.1"),
    ("0.5..1", "needs a step"),
])  # fmt: skip
def test_ranges_that_hold_nothing(text, message):
    with pytest.raises(SweepError, match=message.replace(".", r"\.")):
        values_of(text, "here")


def test_so_many_values_and_no_more(monkeypatch):
    monkeypatch.setattr(axes, "STEPS_MAX", 1_000)
    assert len(values_of("1..1000", "here")) == 1_000
    with pytest.raises(SweepError, match="here: more than 1,000 values"):
        values_of("0..1000", "here")
    assert len(axis(("k",), ((i,) for i in range(1_000)), "here").steps) == 1_000
    with pytest.raises(SweepError, match="here: more than 1,000 values"):
        axis(("k",), ((i,) for i in range(1_001)), "here")
    monkeypatch.undo()
    assert axes.STEPS_MAX == 1_000_000


@pytest.mark.parametrize(("text", "parts"), [
    ("a,b", ["a", "b"]), ("a", ["a"]), ("", [""]), (",", ["", ""]), ("[1,2],3", ["[1,2]", "3"]),
    ("'a,b',c", ["'a,b'", "c"]), ('"a\\",b",c', ['"a\\",b"', "c"]), ("{x=[1,2]},y",
     ["{x=[1,2]}", "y"]), ("(1,2),3", ["(1,2)", "3"]), ("a],b", ["a]", "b"]),
    ("'[',b", ["'['", "b"]), ("\"'\",b", ["\"'\"", "b"]),
])  # fmt: skip
def test_marks_count_outside_of_brackets_and_quotes(text, parts):
    assert split(text, ",") == parts


@pytest.mark.parametrize(("text", "message"), [
    ("k=1,,2", "a value is missing"), ("k=", "a value is missing"), ("k=1,1.0", "1 stands there"),
    ("k,k=1:2", "a key stands there twice"), ("seed=1,2", "every run has a seed of its own"),
    ("k,m=1", '"1" has 1 values for 2 keys'), ("k,m=1:2:3", "has 3 values for 2 keys"),
    ("k..m=1", '"k..m" is no key'), ("k,m=1:2,1.0:2", "1 : 2 stands there twice"),
    ('k=3,"3"', "3 stands there twice"), ("command=[]", '"command" is a column of the results'),
])  # fmt: skip
def test_axes_that_are_none(text, message):
    with pytest.raises(SweepError, match=message.replace(".", r"\.")):
        parse(text)


def test_two_values_of_one_name_would_be_one_in_tables_and_figures():
    with pytest.raises(SweepError, match="k: a stands there twice"):
        axis(("k",), [(Named("a", 3),), (Named("a", 4),)], "k")
    assert len(axis(("k",), [(Named("a", 3),), (Named("b", 4),), ("c",)], "k").steps) == 3


def test_values_as_tables_people_and_keys_have_them():
    long = Named("last", {"value": 1})
    assert [column(one) for one in (long, 3, 0.5, True, "a")] == ["last", 3, 0.5, True, "a"]
    assert column([1, 2]) == "[1, 2]"
    assert [shown(one) for one in (True, False, 0.25, 1e6, 3, long)] == [
        "true", "false", "0.25", "1e+06", "3", "last",
    ]  # fmt: skip
    assert canonical({"b": 1.0, "a": [2, 0.5]}) == canonical({"a": [2.0, 0.5], "b": 1})
    assert canonical(True) != canonical(1)
    assert canonical(None) == "null"
    assert canonical(0.5) != canonical(1)


@pytest.mark.parametrize(("text", "value"), [
    ("7 + 2", 9), ("7 - 2", 5), ("7 * 2", 14), ("7 / 2", 3.5), ("7 // 2", 3), ("7 % 4", 3),
    ("-7 + k", -4), ("min(k, 2)", 2), ("max(k, 2)", 3), ("abs(-k)", 3), ("round(2.6)", 3),
    ("floor(2.6)", 2), ("ceil(2.1)", 3), ("sqrt(16)", 4), ("log2(8)", 3), ("min + 1", 6),
    ("min (k, 2)", 2), ("a.b.c0 - a.b", 10), ("2 * (k + 1)", 8),
])  # fmt: skip
def test_each_part_of_a_formula(text, value):
    keys = {"k": 3, "min": 5, "a.b.c0": 12, "a.b": 2}
    assert Formula(text, "here").value(keys.__getitem__) == value


@pytest.mark.parametrize(
    ("text", "message"),
    [("+k", "has more in it"), ("k < 2", "has more in it"), ("min(k, key=2)", "has more in it"),
     ("on + 1", "on is no number"), ("True + 1", "there is no True"), ("k ** 2", "has more in it"),
     ("1e400", "comes to no number"), ("9" * 400, "comes to no number"),
     ("event.7.at_s", "there is no event.7.at_s"), ("pow(k, 2)", "here: pow.k, 2. has more in it")],
)  # fmt: skip
def test_what_is_no_formula(text, message):
    with pytest.raises(SweepError, match=message):
        Formula(text, "here").value(lambda key: _look_up(key, {"k": 3, "on": True}, {"event": []}))


def test_a_formula_has_a_length():
    most = "1" + "+1" * ((LENGTH_MAX - 1) // 2)
    assert LENGTH_MAX == 500
    assert Formula(most + " ", "here").value({}.__getitem__) == 250
    with pytest.raises(SweepError, match="here: longer than 500 characters"):
        Formula(most + "  ", "here")


def test_lists_and_tables_have_a_length():
    assert (LIST_MAX, TABLES_MAX) == (64, 16)
    lists = {"short": list(range(LIST_MAX)), "long": list(range(LIST_MAX + 1)), "none": []}
    assert set(flat(lists)) == {"short", "none"}
    tables = [{"a": i} for i in range(TABLES_MAX + 1)]
    row = flat({"t": tables})
    assert row["t.count"] == TABLES_MAX + 1
    assert row[f"t.{TABLES_MAX - 1}.a"] == TABLES_MAX - 1
    assert f"t.{TABLES_MAX}.a" not in row
    assert (row["t.a"], row["t.max.a"]) == (TABLES_MAX / 2, TABLES_MAX)


def test_flags_are_no_numbers_to_average():
    row = flat({"t": [{"on": True, "a": 1, "b": None}, {"on": False, "a": None, "b": None}]})
    assert "t.on" not in row
    assert (row["t.0.on"], row["t.1.on"]) == (True, False)
    assert (row["t.a"], row["t.b"], row["t.max.b"]) == (1, None, None)
    assert flat({"wall_s": 1, "kind": "x", "x": {"wall_s": 2}}) == {"x.wall_s": 2}
