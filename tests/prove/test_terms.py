"""Terms are what their formulas are, whatever was decided on the way."""

import random

import pytest

from innervate.prove.errors import ProveError
from innervate.prove.solve import Formulas, Question, width_of
from innervate.prove.terms import KNOWN, Terms

NUMBERS = (-70_000, -129, -1, 0, 1, 2, 31, 255, 65_535, 1 << 20)
OPERATIONS = {
    "add": "add", "sub": "sub", "mul": "mul", "div": "div", "mod": "mod", "and": "bits_and",
    "or": "bits_or", "xor": "bits_xor", "shl": "shl", "shr": "shr",
}  # fmt: skip


@pytest.mark.parametrize("most", [1 << 20, 3])
@pytest.mark.parametrize("op", OPERATIONS)
def test_the_solver_computes_as_python_does(op, most):
    terms = Terms()
    a, b = terms.unknown("a", -70_000, most), terms.unknown("b", -129, 255)
    if op in ("div", "mod"):
        b = terms.unknown("b", 1, 255)
    elif op in ("shl", "shr"):
        b = terms.unknown("b", 0, 20)
    made = getattr(terms, OPERATIONS[op])(a, b)
    question = Question(Formulas(), [])
    draw = random.Random(f"terms {op}")
    for x in dict.fromkeys(min(most, one) for one in NUMBERS):
        y = draw.randint(b.low, b.high)
        found = question.values(terms.same(a, terms.number(x)), terms.same(b, terms.number(y)))
        assert found is not None
        assert question.value(made) == KNOWN[op](x, y), (op, x, y)
        assert made.low <= KNOWN[op](x, y) <= made.high


def test_numbers_of_one_base_are_compared_without_it():
    terms = Terms()
    base = terms.unknown("base", 0, 65_535)
    a, b = (terms.unknown(name, 0, 65_535) for name in "ab")
    x, y = (terms.wrapped(base, ahead, 65_535) for ahead in (a, b))
    plain = [terms.bits_and(terms.add(base, ahead), terms.number(65_535)) for ahead in (a, b)]
    mask = terms.number(65_535)
    question = Question(Formulas(), [])
    for made, long in (
        (terms.same(x, y), terms.same(*plain)),
        (terms.bits_and(terms.sub(x, y), mask), terms.bits_and(terms.sub(*plain), mask)),
        (terms.bits_and(terms.sub(x, base), mask), terms.bits_and(terms.sub(plain[0], base), mask)),
        (terms.pick(terms.less(a, b), x, y), terms.pick(terms.less(a, b), *plain)),
    ):
        assert question.values(terms.negated(terms.same(made, long))) is None


def test_ranges_decide_what_they_can():
    terms = Terms()
    a, b = terms.unknown("a", 0, 9), terms.unknown("b", 10, 20)
    assert terms.less(a, b) is terms.true
    assert terms.same(a, b) is terms.false
    assert terms.all(terms.less(a, a), terms.true) is terms.false
    c = terms.less(a, terms.number(5))
    assert terms.any(c, terms.negated(c)) is terms.true
    assert terms.pick(c, terms.pick(c, a, b), b) is terms.pick(c, a, b)


def test_what_is_compared_has_one_form_whichever_stands_first():
    """And what is picked of known numbers is told by what it is picked by."""
    terms = Terms()
    a, b = terms.unknown("a", 0, 9), terms.unknown("b", 0, 9)
    three, four = terms.number(3), terms.number(4)
    if_ = terms.less(a, b)
    one = terms.pick(if_, three, four)
    for same in (terms.same, lambda x, y: terms.same(y, x)):
        assert same(a, b).args == (a, b)
        assert same(a, three).args == (a, three)
        assert same(one, three) is if_
        assert same(one, four) is terms.negated(if_)


@pytest.mark.parametrize(("low", "high"), [
    (1, 4), (-3, 3), (0, 5), (2, 9), (-4, 3), (0, 7), (-1, 0), (-8, -5), (1, 2),
])  # fmt: skip
def test_an_unknown_is_all_of_its_range_and_nothing_else(low, high):
    terms = Terms()
    x = terms.unknown("x", low, high)
    question = Question(Formulas(), [])
    is_other = [terms.negated(terms.same(x, terms.number(k))) for k in range(low, high + 1)]
    assert question.values(*is_other) is None
    for k in range(low, high + 1):
        assert question.values(terms.same(x, terms.number(k))) == {"x": k}


@pytest.mark.parametrize(("low", "high", "width"), [
    (0, 0, 1), (0, 1, 2), (0, 7, 4), (0, 8, 5), (-1, 0, 1), (-4, 3, 3), (-5, 3, 4), (-4, 4, 4),
])  # fmt: skip
def test_a_number_has_as_many_bits_as_its_range_wants(low, high, width):
    assert width_of(low, high) == width


def test_which_of_some_truths_hold_is_told_in_their_order():
    terms = Terms()
    x = terms.unknown("x", 0, 9)
    less = [terms.less(x, terms.number(k)) for k in (3, 5, 7, 9)]
    question = Question(Formulas(), [terms.same(x, terms.number(5))])
    assert question.values() == {"x": 5}
    assert question.which(less) == [False, False, True, True]
    assert [question.which([one]) for one in less] == [[False], [False], [True], [True]]
    assert question.which([]) == []
    assert question.which(less[:2]) == [False, False]


def test_what_changes_nothing_leaves_a_term_as_it_is():
    terms = Terms()
    a, flag = terms.unknown("a", -5, 9), terms.unknown("f", 0, 1)
    none, one = terms.number(0), terms.number(1)
    for made in (terms.add(a, none), terms.add(none, a), terms.sub(a, none), terms.mul(a, one),
                 terms.mul(one, a), terms.div(a, one)):  # fmt: skip
        assert made is a
    for made in (terms.sub(a, a), terms.mul(a, none), terms.mul(none, a)):
        assert made is none
    assert terms.mul(flag, a) is terms.mul(a, flag) is terms.pick(terms.as_truth(flag), a, none)
    small = terms.unknown("s", 0, 7)
    assert terms.mod(small, terms.number(8)) is small
    assert terms.mod(small, terms.number(7)) is not small
    assert terms.mod(a, terms.number(100)) is not a  # it may be below 0
    assert terms.bits_and(small, terms.number(7)) is terms.bits_and(terms.number(7), small) is small
    assert terms.bits_and(small, terms.number(3)) is not small


def test_of_what_is_joined_both_truths_are_possible():
    terms = Terms()
    a, b = (terms.unknown(name, 0, 9) for name in "ab")
    parts = [terms.less(a, b), terms.same(a, terms.number(3))]
    for joined in (terms.all(*parts), terms.any(*parts)):
        assert (joined.low, joined.high) == (0, 1)


def test_one_name_is_not_taken_for_two_numbers():
    """Else the wide one would have the range of the narrow one, and less could be."""
    terms = Terms()
    wide, narrow = terms.unknown("n", 0, 7), terms.unknown("n", 0, 5)
    most, some = terms.same(wide, terms.number(7)), terms.less(narrow, terms.number(4))
    assert Question(Formulas(), []).values(most) == {"n": 7}
    with pytest.raises(ProveError, match=r"^two unknowns are called n$"):
        Question(Formulas(), []).values(most, some)
