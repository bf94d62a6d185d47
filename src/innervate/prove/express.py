"""Values of the dialect's expressions, as terms."""

from __future__ import annotations

import ast
from collections.abc import Callable
from typing import Any

from innervate.dialect.source import Function
from innervate.prove.errors import ProveError
from innervate.prove.records import (
    Action,
    Array,
    Demand,
    Frames,
    Outbox,
    Partly,
    Record,
    State,
    Store,
    either,
    merged,
    of_each,
)
from innervate.prove.terms import Term, Terms

BITS = 32  # what a microcontroller's numbers have
MOST = (1 << (BITS - 1)) - 1
FRAMES = Frames()


class Expressions:
    """The half of a machine that knows expressions; see execute.py for the other."""

    functions: dict[str, Function]
    terms: Terms
    out: Outbox
    demands: list[Demand]

    def value(self, node: ast.expr, state: State) -> Any:
        """A term, or a reference to a record, an array, the outbox's frames."""
        match node:
            case ast.Constant(value=int() as known):
                if isinstance(known, bool):
                    return self.terms.truth_of(known)
                return self.terms.number(int(known))
            case ast.Name() if node.id in state.names:
                return self.there(state.names[node.id], node, state)
            case ast.Name() if node.id in state.call.function.constants:
                return self.terms.number(state.call.function.constants[node.id])
            case ast.Attribute():
                return self.attribute(node, state)
            case ast.Subscript():
                return self.subscript(node, state)
            case ast.BoolOp():
                return self.connected(node, state, self.term)
            case ast.UnaryOp():
                return self.unary(node, state)
            case ast.IfExp():
                return self.choice(node, state)
            case ast.Compare():
                return self.compare(node, state)
            case ast.BinOp():
                a = self.integer(node.left, state)
                b = self.integer(node.right, state)
                return self.binary(node.op, a, b, node, state)
            case ast.Call():
                return self.there(self.apply(node, state), node, state)
        raise ProveError(f"{self.place(node, state)}: {ast.unparse(node)} is not of the dialect")

    def there(self, found: Any, node: ast.expr, state: State) -> Any:
        """What a name stands for, or a call returned; it must do so on all paths that come here."""
        if isinstance(found, Partly):
            self.demand("what is used has a value", found.where, node, state)
            return found.value
        if found is None:
            raise ProveError(f"{self.place(node, state)}: {ast.unparse(node)} has no value")
        return found

    def term(self, node: ast.expr, state: State) -> Term:
        """The value of an expression that must be a number or a truth."""
        found = self.value(node, state)
        if not isinstance(found, Term):
            raise ProveError(f"{self.place(node, state)}: {ast.unparse(node)} is no number")
        return found

    def integer(self, node: ast.expr, state: State) -> Term:
        """The value of an expression as a number."""
        return self.terms.as_number(self.term(node, state))

    def truth(self, node: ast.expr, state: State) -> Term:
        """Whether an expression is not 0; what else it is does not matter."""
        match node:
            case ast.BoolOp():
                return self.connected(node, state, self.truth)
            case ast.UnaryOp(op=ast.Not()):
                return self.terms.negated(self.truth(node.operand, state))
        return self.terms.as_truth(self.term(node, state))

    def place(self, node: ast.AST, state: State) -> str:
        """Where something stands, for people."""
        function = state.call.function
        file = function.path.replace("\\", "/").rpartition("/")[2]
        return f"{function.name} ({file}:{getattr(node, 'lineno', 0)})"

    def here(self, state: State) -> Term:
        """Where the paths of a state are taken, its function's call being one of them."""
        return self.terms.all(state.call.under, state.path)

    def demand(self, what: str, holds: Term, node: ast.AST, state: State) -> None:
        """Note what must hold on the paths that come here."""
        if holds is not self.terms.true:
            guard = self.here(state)
            self.demands.append(Demand(what, guard, holds, self.place(node, state)))

    def check_index(self, index: Term, length: int, node: ast.AST, state: State) -> None:
        """An index must lie within its array."""
        holds = self.terms.within(index, 0, length - 1)
        self.demand("no index leaves its array", holds, node, state)

    def attribute(self, node: ast.Attribute, state: State) -> Any:
        """A field of a record."""
        owner = self.value(node.value, state)
        if owner is self.out and node.attr == "frame":
            return FRAMES
        return of_each(self.terms, owner, lambda record: self.field(record, node, state))

    def field(self, record: Any, node: ast.Attribute, state: State) -> Any:
        """A field of one record."""
        if isinstance(record, Record):
            if node.attr in record.parts:
                return record.parts[node.attr]
            if node.attr in record.fields:
                length = record.fields[node.attr][0]
                if length:
                    return Array(record, node.attr, length)
                return state.store[record, node.attr, None]
        raise ProveError(f"{self.place(node, state)}: {ast.unparse(node)} is not declared")

    def subscript(self, node: ast.Subscript, state: State) -> Any:
        """An element of an array, or a record of a table."""
        owner = self.value(node.value, state)
        if owner is FRAMES:
            actions = self.value(node.slice, state)
            return of_each(self.terms, actions, lambda one: self.frame_of(one, node, state))
        index = self.integer(node.slice, state)
        if isinstance(owner, tuple):
            if index.value is None or not 0 <= index.value < len(owner):
                raise ProveError(f"{self.place(node, state)}: which record is not known")
            return owner[index.value]
        return of_each(self.terms, owner, lambda array: self.element(array, index, node, state))

    def frame_of(self, action: Any, node: ast.Subscript, state: State) -> Record:
        """The frame of an action."""
        if not isinstance(action, Action):
            what = "is none of a frame that was just sent or delivered"
            raise ProveError(f"{self.place(node, state)}: {ast.unparse(node)} {what}")
        return action.frame

    def element(self, array: Array, index: Term, node: ast.AST, state: State) -> Term:
        """An element of one array."""
        self.check_index(index, array.length, node, state)
        return chosen(self.terms, array, index, state.store)

    def connected(self, node: ast.BoolOp, state: State, read: Read) -> Term:
        """`and`, `or`: the part that decides; what stands later is asked only where it matters."""
        terms = self.terms
        is_and = isinstance(node.op, ast.And)
        found: Term = read(node.values[0], state)
        for part in node.values[1:]:
            holds = terms.as_truth(found)
            goes = holds if is_and else terms.negated(holds)
            if goes is terms.false:
                break
            one = self.behind(goes, part, state, read)
            if found.is_truth and one.is_truth:
                found = terms.all(found, one) if is_and else terms.any(found, one)
            else:
                found = terms.pick(goes, one, found)
        return found

    def behind(self, goes: Term, node: ast.expr, state: State, read: Read) -> Term:
        """What an expression is that is asked only where a truth holds."""
        terms, whole = self.terms, state.path
        if goes is terms.true:
            return read(node, state)
        inner = state.fork(terms.all(whole, goes))
        found = read(node, inner)
        inner.path = whole
        changed = merged(terms, goes, inner, state, whole)
        state.store, state.names = changed.store, changed.names
        return found

    def choice(self, node: ast.IfExp, state: State) -> Any:
        """`a if test else b`."""
        terms, whole = self.terms, state.path
        test = self.truth(node.test, state)
        self.note(node, test, state)  # type: ignore[attr-defined]
        if test.op == "const":
            return self.value(node.body if test is terms.true else node.orelse, state)
        yes = state.fork(terms.all(whole, test))
        no = state.fork(terms.all(whole, terms.negated(test)))
        a, b = self.value(node.body, yes), self.value(node.orelse, no)
        changed = merged(terms, test, yes, no, whole)
        state.store, state.names = changed.store, changed.names
        return either(terms, test, a, b)

    def unary(self, node: ast.UnaryOp, state: State) -> Term:
        """The operators `not`, `-`, `+` and `~`."""
        if isinstance(node.op, ast.Not):
            return self.truth(node, state)
        number = self.integer(node.operand, state)
        if isinstance(node.op, ast.UAdd):
            return number
        less = 0 if isinstance(node.op, ast.USub) else -1
        return self.fitting(self.terms.sub(self.terms.number(less), number), node, state)

    def compare(self, node: ast.Compare, state: State) -> Term:
        """One comparison or several in a chain, which ends with the first that does not hold."""
        terms, found = self.terms, self.terms.true
        if not all(type(op) in COMPARISONS for op in node.ops):
            raise ProveError(f"{self.place(node, state)}: no such comparison")
        a = self.term(node.left, state)
        for op, part in zip(node.ops, node.comparators, strict=True):
            if found is terms.false:
                break
            b = self.behind(found, part, state, self.term)
            found = terms.all(found, COMPARISONS[type(op)](terms, a, b))
            a = b
        return found

    def binary(self, op: ast.operator, a: Term, b: Term, node: ast.AST, state: State) -> Term:
        """Arithmetic, and what it must keep."""
        terms = self.terms
        if isinstance(op, ast.FloorDiv | ast.Mod):
            least = terms.at_most(terms.number(1), b)
            self.demand("what is divided by is at least 1", least, node, state)
        if isinstance(op, ast.LShift | ast.RShift):
            self.demand("shifts are by 0 .. 31", terms.within(b, 0, 31), node, state)
            b = terms.pick(terms.within(b, 0, 31), b, terms.number(0))
            b = self.narrowed(b, 0, 31)
        made: Term = getattr(terms, OPERATIONS[type(op)])(a, b)
        return self.fitting(made, node, state)

    def fitting(self, made: Term, node: ast.AST, state: State) -> Term:
        """A number that was worked out, which must fit."""
        holds = self.terms.within(made, -MOST - 1, MOST)
        self.demand("every number fits 32 bits", holds, node, state)
        return made

    def narrowed(self, a: Term, low: int, high: int) -> Term:
        """A term known to lie in a range, for those that its own range is too wide for."""
        if low <= a.low and a.high <= high:
            return a
        return self.terms.bits_and(a, self.terms.number(high))

    def apply(self, node: ast.Call, state: State) -> Any:
        """A call: of min, max, abs, an action, a draw, or a function of the protocol."""
        assert isinstance(node.func, ast.Name)
        name = state.call.function.calls.get(node.func.id)
        if name is None:
            return self.plain(node, state)
        args = [self.value(arg, state) for arg in node.args]
        function = self.functions.get(name)
        if function is None:
            raise ProveError(f"{self.place(node, state)}: {node.func.id} is not of the protocol")
        found = self.builtin(function, args, state)  # type: ignore[attr-defined]
        if found is not None:
            return found
        under = self.here(state)
        store, found = self.call(function, args, state.store, under)  # type: ignore[attr-defined]
        state.store = store
        return found

    def plain(self, node: ast.Call, state: State) -> Term:
        """min, max or abs of numbers."""
        terms = self.terms
        args = [self.integer(arg, state) for arg in node.args]
        name = node.func.id  # type: ignore[attr-defined]
        if name == "abs":
            less = terms.sub(terms.number(0), args[0])
            found = terms.pick(terms.less(args[0], terms.number(0)), less, args[0])
            return self.fitting(found, node, state)
        if name not in ("min", "max"):
            raise ProveError(f"{self.place(node, state)}: {name} is not of the dialect")
        found = args[0]
        for one in args[1:]:
            found = least(terms, found, one) if name == "min" else greatest(terms, found, one)
        return found


Read = Callable[[ast.expr, State], Term]
COMPARISONS: dict[type[ast.cmpop], Callable[[Terms, Term, Term], Term]] = {
    ast.Eq: lambda terms, a, b: terms.same(a, b),
    ast.NotEq: lambda terms, a, b: terms.negated(terms.same(a, b)),
    ast.Lt: lambda terms, a, b: terms.less(a, b),
    ast.LtE: lambda terms, a, b: terms.at_most(a, b),
    ast.Gt: lambda terms, a, b: terms.less(b, a),
    ast.GtE: lambda terms, a, b: terms.at_most(b, a),
}
OPERATIONS: dict[type[ast.operator], str] = {
    ast.Add: "add", ast.Sub: "sub", ast.Mult: "mul", ast.FloorDiv: "div", ast.Mod: "mod",
    ast.BitAnd: "bits_and", ast.BitOr: "bits_or", ast.BitXor: "bits_xor",
    ast.LShift: "shl", ast.RShift: "shr",
}  # fmt: skip


def chosen(terms: Terms, array: Array, index: Term, store: Store) -> Term:
    """The element at an index; of one outside, any of them."""
    last = min(max(index.low, 0), array.length - 1), max(min(index.high, array.length - 1), 0)
    found = store[array.record, array.name, last[0]]
    for k in range(last[0] + 1, last[1] + 1):
        here = terms.same(index, terms.number(k))
        found = terms.pick(here, store[array.record, array.name, k], found)
    return found


def least(terms: Terms, a: Term, b: Term) -> Term:
    """The lesser of two; its range says so."""
    found = terms.pick(terms.less(b, a), b, a)
    return terms.bounded(found, min(a.low, b.low), min(a.high, b.high))


def greatest(terms: Terms, a: Term, b: Term) -> Term:
    """The greater of two; its range says so."""
    found = terms.pick(terms.less(a, b), b, a)
    return terms.bounded(found, max(a.low, b.low), max(a.high, b.high))
