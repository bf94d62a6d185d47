"""Plans: texts to axes, derived values, seeds; properties with Hypothesis."""

import math
from contextlib import suppress

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from innervate.sweeping import SweepError, make_plan
from innervate.sweeping.derive import Formula
from innervate.sweeping.vary import Named, canonical, parse, split, values_of

WORD = st.from_regex(r"[a-z][a-z_]{0,6}", fullmatch=True).filter(
    lambda word: word not in ("true", "false", "inf", "nan")
)
KEY = st.lists(WORD, min_size=1, max_size=3).map(".".join).filter(lambda key: key != "seed")
NUMBER = st.integers(-1000, 1000)
SCALAR = st.one_of(NUMBER, st.booleans(), WORD)
SKIN = {
    "kind": "skin", "duration_s": 0.2, "patch": [{"columns": 3, "rows": 1}],
    "interface": [{"row": 0, "column": 0, "port": "W"}],
}  # fmt: skip


def written(value):
    return str(value).lower() if isinstance(value, bool) else str(value)


@given(KEY, st.lists(SCALAR, min_size=1, max_size=6, unique_by=lambda v: (type(v), v)))
def test_what_is_written_is_what_is_read(key, values):
    made = parse(f"{key}={','.join(map(written, values))}")
    assert made.keys == (key,)
    assert [step[0] for step in made.steps] == values
    assert [type(step[0]) for step in made.steps] == [type(value) for value in values]


@given(st.lists(KEY, min_size=2, max_size=3, unique=True), st.data())
def test_keys_that_go_together(keys, data):
    rows = data.draw(st.lists(
        st.tuples(*(NUMBER for _ in keys)), min_size=1, max_size=5, unique=True))  # fmt: skip
    text = ",".join(":".join(map(str, row)) for row in rows)
    made = parse(f"{','.join(keys)}={text}")
    assert made.keys == tuple(keys)
    assert list(made.steps) == rows


@given(NUMBER, NUMBER, st.integers(1, 50))
def test_ranges_include_both_ends(first, last, step):
    if last < first:
        with pytest.raises(SweepError, match="leads nowhere"):
            values_of(f"{first}..{last}..{step}", "here")
        return
    found = values_of(f"{first}..{last}..{step}", "here")
    assert found == list(range(first, last + 1, step))


def test_ranges_of_fractions_are_exact():
    assert values_of("0..1..0.1", "here") == [i / 10 for i in range(11)]
    assert values_of("3..1..-1", "here") == [3, 2, 1]


@given(st.text(max_size=30))
@settings(max_examples=300)
def test_any_text_is_read_or_refused_in_one_line(text):
    with suppress(SweepError):
        assert parse(text).steps


@pytest.mark.parametrize(("text", "message"), [
    ("protocol.k", "write it as key=values"),
    ("protocol.k=", "a value is missing"),
    ("protocol.k=3,,5", "a value is missing"),
    ("protocol.k=3,3", "twice"),
    ("protocol.k=3,3.0", "twice"),
    ("seed=1..5", "--repeat"),
    ("a b=3", "no key"),
    ("k=2..1", "leads nowhere"),
    ("k=1..2..0", "leads nowhere"),
    ("k=0.5..2.5", "needs a step"),
    ("k=1..99999999", "more than"),
    ("a,b=1:2,3", "1 values for 2 keys"),
    ("a,a=1:2", "twice"),
])  # fmt: skip
def test_mistakes_are_told(text, message):
    with pytest.raises(SweepError, match=message):
        parse(text)


def test_lists_and_tables_are_values():
    made = parse("timing.hop_latency_us=[80,160],[1, 2]")
    assert made.steps == (([80, 160],), ([1, 2],))
    assert split('a,"b,c",[1,{x=2,y=3}]', ",") == ["a", '"b,c"', "[1,{x=2,y=3}]"]


@given(st.integers(1, 100), st.integers(1, 100), st.integers(1, 100))
def test_formulas_are_arithmetic(a, b, c):
    values = {"protocol.k": a, "x": b, "event.0.at_s": c}
    formula = Formula("max(protocol.k, 2) + x / event.0.at_s - (x // 3) % 7", "here")
    assert formula.value(values.__getitem__) == max(a, 2) + b / c - (b // 3) % 7


@pytest.mark.parametrize(("text", "message"), [
    ("1 +", "no arithmetic"),
    ("missing + 1", "there is no missing"),
    ("1 / (x - 3)", "divides by zero"),
    ("name * 2", "name is no number"),
    ("__import__('os')", "has more in it|no arithmetic|there is no"),
    ("x ** 9999", "has more in it"),
    ("[1]", "has more in it"),
    ("sqrt(0 - 1)", "comes to no number"),
    ("min()", "comes to no number"),
    ("'a'", "has more in it"),
])  # fmt: skip
def test_formulas_that_are_none(text, message):
    with pytest.raises(SweepError, match=message):
        Formula(text, "here").value({"x": 3, "name": "four"}.__getitem__)


def plan(**options):
    return make_plan(SKIN, **options)


def seeds(made, repeats=4):
    return {(p.label, r): made.seed(p, r) for p in made.points for r in range(repeats)}


@given(st.lists(st.integers(2, 40), min_size=1, max_size=6, unique=True), st.data())
@settings(max_examples=30, deadline=None)
def test_seeds_do_not_depend_on_what_else_is_in_the_plan(values, data):
    fewer = data.draw(st.lists(st.sampled_from(values), min_size=1, unique=True))
    whole = seeds(plan(vary={"protocol.k": values}, seed=5))
    part = seeds(plan(vary={"protocol.k": fewer}, seed=5))
    assert part.items() <= whole.items()
    assert len(set(whole.values())) == len(whole)
    assert all(0 <= seed < 2**48 for seed in whole.values())
    assert set(seeds(plan(vary={"protocol.k": values}, seed=6)).values()).isdisjoint(whole.values())


def test_the_order_of_axes_changes_no_seed():
    a = plan(vary={"protocol.k": [2, 3], "protocol.beacon_hz": [50, 250]}, seed=1)
    b = plan(vary={"protocol.beacon_hz": [50.0, 250.0], "protocol.k": [2, 3]}, seed=1)
    assert {p.digest for p in a.points} == {p.digest for p in b.points}
    assert sorted(seeds(a).values()) == sorted(seeds(b).values())


def test_paired_points_share_their_seeds_and_no_others_do():
    made = plan(vary={"protocol.rule": ["paper", "strict"], "protocol.k": [2, 3]}, seed=1,
                paired="protocol.rule")  # fmt: skip
    by_label = {p.label: [made.seed(p, r) for r in range(3)] for p in made.points}
    paper, strict = (
        by_label[f"protocol.rule={rule}, protocol.k=2"] for rule in ("paper", "strict")
    )
    assert paper == strict
    assert paper != by_label["protocol.rule=paper, protocol.k=3"]
    everything = plan(vary={"protocol.k": [2, 3]}, seed=1, paired="all")
    assert len(set(seeds(everything).values())) == 4


def test_points_are_all_combinations_the_last_axis_fastest():
    made = plan(vary={"protocol.k": [2, 3], ("data.rate_hz", "data.queue"): [(0, 8), (10, 4)]},
                derive={"duration_s": "protocol.k / 10 + data.queue / 100"})  # fmt: skip
    assert [p.columns for p in made.points] == [
        {"protocol.k": k, "data.rate_hz": r, "data.queue": q, "duration_s": k / 10 + q / 100}
        for k in (2, 3) for r, q in ((0, 8), (10, 4))
    ]  # fmt: skip


def test_the_seed_of_a_run_is_not_derived():
    """The table would say it, and the run would have another."""
    with pytest.raises(SweepError, match="derive seed: every run has a seed of its own"):
        plan(vary={"protocol.k": [2]}, derive={"seed": "protocol.k"})


def test_a_formula_sees_the_scenario_and_its_defaults():
    made = plan(vary={"protocol.k": [2]}, derive={"protocol.m": "protocol.k + protocol.max_depth"})
    assert dict(made.points[0].settings)["protocol.m"] == 66


def test_named_values_go_by_their_name():
    ends = [Named("left", [{"row": 0, "column": 0}]), Named("right", [{"row": 0, "column": 2}])]
    made = plan(vary={"interface": ends})
    assert [p.columns["interface"] for p in made.points] == ["left", "right"]
    assert dict(made.points[1].settings)["interface"] == [{"row": 0, "column": 2}]


@pytest.mark.parametrize(("options", "message"), [
    ({"vary": ["protocol.k=2,3", "protocol.k=4"]}, "varied twice"),
    ({"vary": ["protocol.k=1..2000", "data.queue=1..2000"]}, "at most"),
    ({"vary": ["protocol.k=2"], "paired": "data.queue"}, "not varied"),
    ({"repeat": 0}, "from 1"),
    ({"repeat": "3"}, "repeat must be a whole number from 1"),
    ({"repeat": 2.5}, "repeat must be a whole number from 1"),
    ({"batch": 0}, "from 1"),
    ({"until": "routed"}, "write it as"),
    ({"until": "x.ci=0%"}, "write it as"),
])  # fmt: skip
def test_plans_that_cannot_be_kept(options, message):
    with pytest.raises(SweepError, match=message):
        assert plan(**options).points


@given(st.recursive(SCALAR | st.floats(allow_nan=False, allow_infinity=False),
                    lambda inner: st.lists(inner, max_size=3)
                    | st.dictionaries(WORD, inner, max_size=3), max_leaves=8))  # fmt: skip
def test_equal_values_have_one_text(value):
    assert canonical(value) == canonical(value)
    if isinstance(value, int) and not isinstance(value, bool):
        assert canonical(float(value)) == canonical(value)
    assert canonical([value]) != canonical([value, math.pi])


def test_so_many_runs_and_no_more():
    """What memory cannot hold is refused before anything runs; a rule may end points early."""
    ten = {"vary": {"protocol.k": list(range(2, 12))}, "repeat": 1_000_000}
    assert len(plan(**ten).points) == 10
    ten["vary"]["protocol.k"].append(12)
    with pytest.raises(SweepError, match="11,000,000 runs; a sweep takes at most 10,000,000"):
        assert plan(**ten).points
    assert len(plan(**ten, until="data.loss_ratio.ci=5%").points) == 11


def test_what_a_sweep_does_not_take_is_said():
    with pytest.raises(TypeError, match="a sweep takes no vry"):
        make_plan(SKIN, vry={"protocol.k": [2, 3]})
