"""Whether conditions can all be as said at once, while nothing changes between them.

What cannot is told for certain; of the rest some only seems to be able to.
"""

import ast
from itertools import product

MOST = 4096  # combinations that are tried; of more nothing is told
ORDERS = {ast.Lt: {-1}, ast.LtE: {-1, 0}, ast.Eq: {0}, ast.GtE: {0, 1}, ast.Gt: {1},
          ast.NotEq: {-1, 1}}  # fmt: skip


def possible(conditions):
    """False if no values make each of (condition, truth) as it says; whole numbers, no calls."""
    facts = {}
    for test, _truth in conditions:
        _note(test, facts)
    tries = 1
    for values in facts.values():
        tries *= len(values)
    if tries > MOST:
        return True
    for values in product(*facts.values()):
        world = dict(zip(facts, values, strict=True))
        if all(_is_true(test, world) == truth for test, truth in conditions):
            return True
    return False


def _note(test, facts):
    """Note what a condition hangs on, with all that matters of what it may be.

    A term that is compared with numbers is one of these, or beside one; of two terms it matters
    which is greater; of all else whether it is true.
    """
    if isinstance(test, ast.BoolOp):
        for one in test.values:
            _note(one, facts)
    elif isinstance(test, ast.UnaryOp) and isinstance(test.op, ast.Not):
        _note(test.operand, facts)
    elif (pairs := _pairs(test)) is not None:
        for left, _op, right in pairs:
            term, limit = (right, left) if _number(left) is not None else (left, right)
            if (number := _number(limit)) is not None:
                facts.setdefault(ast.unparse(term), set()).update(range(number - 1, number + 2))
            else:
                facts[_of_two(left, right)] = {-1, 0, 1}
    else:
        facts.setdefault(ast.unparse(test), set()).update((-1, 0, 1))


def _is_true(test, world):
    if isinstance(test, ast.BoolOp):
        found = [_is_true(one, world) for one in test.values]
        return all(found) if isinstance(test.op, ast.And) else any(found)
    if isinstance(test, ast.UnaryOp) and isinstance(test.op, ast.Not):
        return not _is_true(test.operand, world)
    if (pairs := _pairs(test)) is not None:
        return all(_order(left, right, world) in ORDERS[type(op)] for left, op, right in pairs)
    return world[ast.unparse(test)] != 0


def _order(left, right, world):
    """-1, 0, 1: the left term is smaller, the same, greater."""
    if (pair := _of_two(left, right)) in world:
        return world[pair] if pair[0] == ast.unparse(left) else -world[pair]
    one, other = (_value(term, world) for term in (left, right))
    return (one > other) - (one < other)


def _value(term, world):
    number = _number(term)
    return world[ast.unparse(term)] if number is None else number


def _of_two(left, right):
    """Two terms as what is known of them is kept by, whichever is named first."""
    return tuple(sorted((ast.unparse(left), ast.unparse(right))))


def _number(term):
    """A whole number that is written out; None of others."""
    sign = 1
    if isinstance(term, ast.UnaryOp) and isinstance(term.op, ast.USub):
        sign, term = -1, term.operand
    is_whole = isinstance(term, ast.Constant) and isinstance(term.value, int)
    return sign * int(term.value) if is_whole else None


def _pairs(test):
    """The comparisons of neighbours in `a < b <= c`; None of what is no comparison of numbers."""
    if not isinstance(test, ast.Compare) or not all(type(op) in ORDERS for op in test.ops):
        return None
    terms = [test.left, *test.comparators]
    return list(zip(terms, test.ops, terms[1:], strict=False))
