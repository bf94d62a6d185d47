"""Loops without end, as far as they are seen by the way they are written.

What is not seen here is stopped as it goes round: bounded.py.
"""

import ast
from itertools import chain

from innervate.dialect.held import possible
from innervate.dialect.trees import every_node

PURE = {"abs", "max", "min"}
WAYS = 64  # ways through a block that are told apart


def endless(loop):
    """Why a `while` need not end; "" if it is not seen."""
    if not calls(loop.test) and (way := _idle_way(loop)) is not None:
        said = "there is a way through it on which nothing changes"
        sides = [place for place, holds in way if not holds and not place.orelse]
        if not sides:
            return f"{said}; change something, or break"
        return f"{said}; give the if in line {sides[-1].lineno} an else that changes it, or breaks"
    exits = list(_exits_of(loop.body))
    if None in exits or () in exits:
        return ""
    tests = {id(test): test for test in [loop.test, *(one for exit in exits for one in exit)]}
    looked = [_looked_at(test) for test in tests.values()]
    names, records = (set().union(*some) for some in zip(*looked, strict=True))
    inside = [part for statement in loop.body for part in every_node(statement)]
    assigned, touched = _changed(inside)
    if names & assigned or any(_overlap(a, b) for a in records for b in touched):
        return ""
    return "nothing that its condition looks at changes in it; write for i in range(...)"


def _idle_way(loop):
    """A way through a loop's body, to its next round, that changes nothing; None if there is none.

    Whoever takes it once takes it for ever. A call that is handed something may change it. A way is
    the conditions on it: (the `if` or the loop, whether it holds).
    """
    for way in chain(*_idle_ways(loop.body)):
        found = ((loop, True), *way)
        if possible([(place.test, holds) for place, holds in found]):
            return found
    return None


def _idle_ways(statements):
    """The ways that change nothing to the end of a block, and those to a `continue`."""
    ends, again = [()], []
    for statement in statements:
        if isinstance(statement, ast.If) and not calls(statement.test):
            through = []
            for side, holds in ((statement.body, True), (statement.orelse, False)):
                on, back = _idle_ways(side)
                through += [((statement, holds), *way) for way in on]
                again += [(*end, (statement, holds), *way) for end in ends for way in back]
            if len(ends) * len(through) > WAYS:
                ends = through = [()]  # so many that any is taken for possible
            ends = [(*end, *way) for end in ends for way in through]
            if ends:
                continue
        elif isinstance(statement, ast.Continue):
            return [], again + ends
        elif isinstance(statement, ast.Pass):
            continue
        return [], again
    return ends, again


def calls(node):
    """True if something is called that may change what it is handed."""
    return any(isinstance(part, ast.Call) and getattr(part.func, "id", "") not in PURE
               for part in every_node(node))  # fmt: skip


def _exits_of(statements, tests=()):
    """The conditions under which each `break` and `return` of a loop is reached; None: not seen.

    Args:
        statements: the loop's body.
        tests: the conditions that they stand under.
    """
    for statement in statements:
        if isinstance(statement, (ast.Break, ast.Return)):
            yield tests
        elif isinstance(statement, ast.If):
            for side in (statement.body, statement.orelse):
                yield from _exits_of(side, (*tests, statement.test))
        elif isinstance(statement, (ast.For, ast.While)):
            if any(isinstance(part, ast.Return) for part in every_node(statement)):
                yield None


def _overlap(one, other):
    """True if two of "node" and "node.seq" are, or can be, the same field."""
    return one == other or other == one.partition(".")[0] or one == other.partition(".")[0]


def _field(part):
    """A number or record, or with it a field of a record: "node.seq"; None of others."""
    while isinstance(part, (ast.Attribute, ast.Subscript)):
        if isinstance(part, ast.Attribute) and isinstance(part.value, ast.Name):
            return f"{part.value.id}.{part.attr}"
        part = part.value
    return part.id if isinstance(part, ast.Name) else None


def _looked_at(test):
    """Names of numbers, and of records or their fields, that a condition looks at."""
    inner = {id(part.value) for part in every_node(test)
             if isinstance(part, (ast.Attribute, ast.Subscript))}  # fmt: skip
    calls = [part for part in every_node(test) if isinstance(part, ast.Call)]
    handed = {id(one) for part in calls for one in part.args}
    called = {id(part.func) for part in calls}
    names = [part for part in every_node(test) if isinstance(part, ast.Name)]
    numbers = {one.id for one in names if id(one) not in inner | called}
    inside = (ast.Attribute, ast.Subscript)
    looked = [one for one in every_node(test) if isinstance(one, inside) or id(one) in handed]
    return numbers, set(map(_field, looked)) - {None}


def _changed(nodes):
    """Names that are assigned to; those and fields that are, or that are handed to a function."""
    assigned, touched = set(), set()
    for node in nodes:
        targets = node.targets if isinstance(node, ast.Assign) else []
        targets = [node.target] if isinstance(node, ast.AugAssign) else targets
        assigned |= {target.id for target in targets if isinstance(target, ast.Name)}
        handed = node.args if isinstance(node, ast.Call) else []
        touched |= {_field(target) for target in [*targets, *handed]} - {None}
    return assigned, assigned | touched
