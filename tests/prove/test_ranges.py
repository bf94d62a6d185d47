"""No term leaves its range and none decides what its range leaves open, for all small values."""

import itertools

import pytest

from innervate.prove.terms import KNOWN, Terms
from tests.prove.test_terms import OPERATIONS

RANGES = [(0, 0), (0, 1), (-1, 0), (0, 5), (3, 6), (-3, 4), (-6, -2), (7, 7), (1, 1), (-1, -1)]


def value_of(term, given):
    """What a term comes to, by its own operations."""
    if term.op == "const":
        return term.args[0]
    if term.op == "var":
        return given[term.args[0]]
    if term.op == "pick":
        if_, a, b = term.args
        return value_of(a if value_of(if_, given) else b, given)
    if term.op in ("all", "any"):
        parts = [value_of(one, given) for one in term.args]
        return int(all(parts) if term.op == "all" else any(parts))
    values = [value_of(one, given) for one in term.args]
    if term.op == "not":
        return int(not values[0])
    if term.op in ("eq", "lt"):
        return int(values[0] == values[1] if term.op == "eq" else values[0] < values[1])
    return KNOWN[term.op](*values)


def cases(op):
    """Two terms of all pairs of ranges that an operation is asked of, and all their values."""
    least = {"div": 1, "mod": 1, "shl": 0, "shr": 0}.get(op)
    for (low, high), (b_low, b_high) in itertools.product(RANGES, RANGES):
        if least is not None and b_low < least:
            continue
        terms = Terms()
        a, b = terms.unknown("a", low, high), terms.unknown("b", b_low, b_high)
        values = itertools.product(range(low, high + 1), range(b_low, b_high + 1))
        yield terms, a, b, list(values)


@pytest.mark.parametrize("op", OPERATIONS)
def test_what_an_operation_comes_to_lies_in_its_range(op):
    for terms, a, b, values in cases(op):
        made = getattr(terms, OPERATIONS[op])(a, b)
        for x, y in values:
            found = value_of(made, {"a": x, "b": y})
            assert found == KNOWN[op](x, y), (op, a.low, a.high, b.low, b.high)
            assert made.low <= found <= made.high, (op, a.low, a.high, b.low, b.high, x, y)


@pytest.mark.parametrize("op", ["div", "mod", "shl", "shr"])
def test_a_range_is_one_whatever_it_may_be_divided_or_shifted_by(op):
    """And what it may be, and comes to something, lies in it."""
    for (low, high), (b_low, b_high) in itertools.product(RANGES, RANGES):
        terms = Terms()
        a, b = terms.unknown("a", low, high), terms.unknown("b", b_low, b_high)
        made = getattr(terms, OPERATIONS[op])(a, b)
        assert made.low <= made.high
        for x, y in itertools.product(range(low, high + 1), range(max(b_low, 1), b_high + 1)):
            assert made.low <= KNOWN[op](x, y) <= made.high, (op, a.low, a.high, b.low, b.high)


@pytest.mark.parametrize("op", ["add", "sub", "mul", "div", "shl", "shr"])
def test_the_range_of_an_operation_is_no_wider_than_what_it_comes_to(op):
    for terms, a, b, values in cases(op):
        made = getattr(terms, OPERATIONS[op])(a, b)
        found = [KNOWN[op](x, y) for x, y in values]
        assert (made.low, made.high) == (min(found), max(found)), (op, a.low, a.high, b.low, b.high)


def test_bits_of_numbers_that_fill_their_bits_make_no_wider_ones():
    for bits in (1, 3, 8):
        terms, half = Terms(), 1 << (bits - 1)
        a, b = (terms.unknown(name, -half, half - 1) for name in "ab")
        for made in (terms.bits_and(a, b), terms.bits_or(a, b), terms.bits_xor(a, b)):
            assert (made.low, made.high) == (-half, half - 1)


COMPARED = {
    "less": lambda x, y: x < y, "same": lambda x, y: x == y, "at_most": lambda x, y: x <= y,
}  # fmt: skip


@pytest.mark.parametrize("name", COMPARED)
def test_comparisons_are_decided_by_ranges_where_they_can_be_and_only_there(name):
    for terms, a, b, values in cases(name):
        made = getattr(terms, name)(a, b)
        wanted = {(x, y): COMPARED[name](x, y) for x, y in values}
        for (x, y), is_so in wanted.items():
            assert value_of(made, {"a": x, "b": y}) == is_so
        assert (made.op == "const") == (len(set(wanted.values())) == 1)


TRUTHS = list(itertools.product((False, True), repeat=3))


def test_truths_joined_in_any_way_are_what_python_says():
    terms = Terms()
    p, q, r = (terms.less(terms.unknown(name, 0, 1), terms.number(1)) for name in "pqr")
    made = {
        lambda a, b, c: a and b and c: terms.all(p, terms.all(q, r), p),
        lambda a, b, c: a or b or c: terms.any(p, terms.any(q, r), terms.false),
        lambda a, b, c: (not a) or b: terms.implies(p, q),
        lambda a, b, c: b if a else c: terms.pick(p, q, r),
        lambda a, b, c: c if a else b: terms.pick(terms.negated(p), q, r),
        lambda a, b, c: False: terms.all(p, q, terms.negated(p)),
        lambda a, b, c: True: terms.any(terms.negated(p), q, p),
        lambda a, b, c: True if a else b: terms.pick(p, terms.true, q),
        lambda a, b, c: False if a else b: terms.pick(p, terms.false, q),
        lambda a, b, c: b if a else True: terms.pick(p, q, terms.true),
        lambda a, b, c: b if a else False: terms.pick(p, q, terms.false),
        lambda a, b, c: (b if a else c) if a else b: terms.pick(p, terms.pick(p, q, r), q),
        lambda a, b, c: c if a else (b if a else c): terms.pick(p, r, terms.pick(p, q, r)),
        lambda a, b, c: bool(a): terms.negated(terms.negated(p)),
    }
    for says, term in made.items():
        for truths in TRUTHS:  # a truth holds where its number is 0
            given = {name: int(not truth) for name, truth in zip("pqr", truths, strict=True)}
            assert value_of(term, given) == says(*truths), (term, truths)


def test_numbers_that_are_picked_and_compared_with_known_ones():
    for low, high in RANGES:
        terms = Terms()
        p = terms.less(terms.unknown("p", 0, 1), terms.number(1))
        x = terms.unknown("x", low, high)
        leafy = terms.pick(p, terms.number(low), terms.pick(terms.negated(p), terms.number(high),
                                                            terms.number(99)))  # fmt: skip
        picked = terms.pick(p, x, terms.number(3))
        for known in range(-7, 9):
            same, other = (terms.same(one, terms.number(known)) for one in (leafy, picked))
            inside = terms.within(picked, known, known + 2)
            for first, value in itertools.product((0, 1), range(low, high + 1)):
                given = {"p": first, "x": value}
                a, b = low if not first else high, value if not first else 3
                assert value_of(same, given) == (a == known)
                assert value_of(other, given) == (b == known)
                assert value_of(inside, given) == (known <= b <= known + 2)
        assert (picked.low, picked.high) == (min(low, 3), max(high, 3))
        number = terms.as_number(p)
        assert [value_of(number, {"p": one}) for one in (0, 1)] == [1, 0]
        assert value_of(terms.as_truth(x), {"x": low}) == (low != 0)


def test_more_that_is_known_of_a_range_narrows_what_was_picked():
    terms = Terms()
    p = terms.less(terms.unknown("p", 0, 1), terms.number(1))
    picked = terms.pick(p, terms.unknown("x", 0, 9), terms.number(20))
    for low, high in ((0, 20), (-1, 20), (0, 21)):
        assert terms.bounded(picked, low, high) is picked
    found = terms.bounded(picked, 2, 20)
    assert (found.low, found.high) == (2, 20)
    assert (terms.bounded(picked, 0, 9).low, terms.bounded(picked, 0, 9).high) == (0, 9)
    x = terms.unknown("x", 0, 9)
    assert terms.bounded(x, 2, 3) is x


def test_unknowns_are_known_by_their_names_and_fresh_ones_by_none():
    terms = Terms()
    assert terms.unknown("a", 0, 9) is terms.unknown("a", 0, 9)
    assert terms.unknown("a", 4, 4) is terms.number(4)
    first, second = terms.fresh("a", 0, 9), terms.fresh("a", 0, 9)
    assert first is not second
    assert (repr(first), repr(second)) == ("a#1", "a#2")
    assert repr(terms.add(first, terms.number(3))) == "add(a#1, 3)"
