"""Values of the dialect's expressions, as terms."""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING, Any

from innervate.dialect.source import Function
from innervate.prove.errors import ProveError
from innervate.prove.records import (
    Action,
    Array,
    Frames,
    Outbox,
    Record,
    State,
    Store,
    each_of,
    either,
    merged,
)
from innervate.prove.terms import Term, Terms

if TYPE_CHECKING:
    from innervate.prove.execute import Call, Demand

BITS = 32  # what a microcontroller's numbers have
MOST = (1 << (BITS - 1)) - 1
FRAMES = Frames()


class Expressions:
    """The half of a machine that knows expressions; see execute.py for the other."""

    functions: dict[str, Function]
    terms: Terms
    out: Outbox
    demands: list[Demand]

    def value(self, node: ast.expr, state: State, call: Call) -> Any:
        """A term, or a reference to a record, an array, the outbox's frames."""
        match node:
            case ast.Constant(value=int() as known):
                if isinstance(known, bool):
                    return self.terms.truth_of(known)
                return self.terms.number(int(known))
            case ast.Name():
                if node.id in state.names:
                    return state.names[node.id]
                if node.id in call.function.constants:
                    return self.terms.number(call.function.constants[node.id])
            case ast.Attribute():
                return self.attribute(node, state, call)
            case ast.Subscript():
                return self.subscript(node, state, call)
            case ast.BoolOp():
                return self.connected(node, state, call)
            case ast.UnaryOp():
                return self.unary(node, state, call)
            case ast.IfExp():
                return self.choice(node, state, call)
            case ast.Compare():
                return self.compare(node, state, call)
            case ast.BinOp():
                a = self.terms.as_number(self.value(node.left, state, call))
                b = self.terms.as_number(self.value(node.right, state, call))
                return self.binary(node, a, b, state, call)
            case ast.Call():
                return self.apply(node, state, call)
        raise ProveError(f"{self.place(node, call)}: {ast.unparse(node)} is not of the dialect")

    def place(self, node: ast.AST, call: Call) -> str:
        """Where something stands, for people."""
        file = call.function.path.replace("\\", "/").rpartition("/")[2]
        return f"{call.function.name} ({file}:{getattr(node, 'lineno', 0)})"

    def demand(self, what: str, holds: Term, node: ast.AST, state: State, call: Call) -> None:
        """Note what must hold on the paths that come here."""
        from innervate.prove.execute import Demand

        if holds is not self.terms.true:
            guard = self.terms.all(call.under, state.path)
            self.demands.append(Demand(what, guard, holds, self.place(node, call)))

    def check_index(
        self, index: Term, length: int, node: ast.AST, state: State, call: Call
    ) -> None:
        """An index must lie within its array."""
        holds = self.terms.within(index, 0, length - 1)
        self.demand("no index leaves its array", holds, node, state, call)

    def attribute(self, node: ast.Attribute, state: State, call: Call) -> Any:
        """A field of a record."""
        owner = self.value(node.value, state, call)
        if owner is self.out:
            return FRAMES
        found: Any = None
        for where, record in each_of(self.terms, owner, self.terms.true):
            one = self.field(record, node, state, call)
            found = one if found is None else either(self.terms, where, one, found)
        return found

    def field(self, record: Any, node: ast.Attribute, state: State, call: Call) -> Any:
        """A field of one record."""
        if isinstance(record, Record):
            if node.attr in record.parts:
                return record.parts[node.attr]
            if node.attr in record.fields:
                length = record.fields[node.attr][0]
                if length:
                    return Array(record, node.attr, length)
                return state.store[record, node.attr, None]
        raise ProveError(f"{self.place(node, call)}: {ast.unparse(node)} is not declared")

    def subscript(self, node: ast.Subscript, state: State, call: Call) -> Any:
        """An element of an array, or a record of a table."""
        owner = self.value(node.value, state, call)
        index = self.value(node.slice, state, call)
        if owner is FRAMES:
            found: Any = None
            for where, action in each_of(self.terms, index, self.terms.true):
                assert isinstance(action, Action)
                found = action.frame if found is None else either(
                    self.terms, where, action.frame, found)  # fmt: skip
            return found
        index = self.terms.as_number(index)
        if isinstance(owner, tuple):
            if index.value is None:
                raise ProveError(f"{self.place(node, call)}: which record is not known")
            return owner[index.value]
        found = None
        for where, array in each_of(self.terms, owner, self.terms.true):
            one = self.element(array, index, node, state, call)
            found = one if found is None else either(self.terms, where, one, found)
        return found

    def element(self, array: Array, index: Term, node: ast.AST, state: State, call: Call) -> Term:
        """An element of one array."""
        self.check_index(index, array.length, node, state, call)
        return chosen(self.terms, array, index, state.store)

    def connected(self, node: ast.BoolOp, state: State, call: Call) -> Term:
        """`and`, `or`: what stands later is asked only where it matters."""
        terms, whole = self.terms, state.path
        is_and = isinstance(node.op, ast.And)
        found = terms.as_truth(self.value(node.values[0], state, call))
        for part in node.values[1:]:
            goes = found if is_and else terms.negated(found)
            if goes is terms.false:
                break
            inner = state.fork(terms.all(whole, goes))
            one = terms.as_truth(self.value(part, inner, call))
            inner.path = whole
            changed = merged(terms, goes, inner, state, whole)
            state.store, state.names = changed.store, changed.names
            found = terms.all(found, one) if is_and else terms.any(found, one)
        return found

    def choice(self, node: ast.IfExp, state: State, call: Call) -> Any:
        """`a if test else b`."""
        terms, whole = self.terms, state.path
        test = terms.as_truth(self.value(node.test, state, call))
        self.note(node, test, state, call)  # type: ignore[attr-defined]
        if test.op == "const":
            return self.value(node.body if test is terms.true else node.orelse, state, call)
        yes = state.fork(terms.all(whole, test))
        no = state.fork(terms.all(whole, terms.negated(test)))
        a, b = self.value(node.body, yes, call), self.value(node.orelse, no, call)
        changed = merged(terms, test, yes, no, whole)
        state.store, state.names = changed.store, changed.names
        return either(terms, test, a, b)

    def unary(self, node: ast.UnaryOp, state: State, call: Call) -> Term:
        """The operators `not`, `-` and `~`."""
        value = self.value(node.operand, state, call)
        if isinstance(node.op, ast.Not):
            return self.terms.negated(self.terms.as_truth(value))
        number = self.terms.as_number(value)
        less = 0 if isinstance(node.op, ast.USub) else -1
        return self.terms.sub(self.terms.number(less), number)

    def compare(self, node: ast.Compare, state: State, call: Call) -> Term:
        """One comparison or several in a chain."""
        parts = [self.value(part, state, call) for part in (node.left, *node.comparators)]
        terms = self.terms
        found = []
        for op, a, b in zip(node.ops, parts, parts[1:], strict=False):
            match op:
                case ast.Eq():
                    found.append(terms.same(a, b))
                case ast.NotEq():
                    found.append(terms.negated(terms.same(a, b)))
                case ast.Lt():
                    found.append(terms.less(a, b))
                case ast.LtE():
                    found.append(terms.at_most(a, b))
                case ast.Gt():
                    found.append(terms.less(b, a))
                case ast.GtE():
                    found.append(terms.at_most(b, a))
                case _:
                    raise ProveError(f"{self.place(node, call)}: no such comparison")
        return terms.all(*found)

    def binary(self, node: ast.BinOp, a: Term, b: Term, state: State, call: Call) -> Term:
        """Arithmetic, and what it must keep."""
        terms, op = self.terms, type(node.op)
        if op in (ast.FloorDiv, ast.Mod):
            least = terms.at_most(terms.number(1), b)
            self.demand("what is divided by is at least 1", least, node, state, call)
        if op in (ast.LShift, ast.RShift):
            self.demand("shifts are by 0 .. 31", terms.within(b, 0, 31), node, state, call)
            b = terms.pick(terms.within(b, 0, 31), b, terms.number(0))
            b = self.narrowed(b, 0, 31)
        made: Term = getattr(terms, OPERATIONS[op])(a, b)
        holds = terms.within(made, -MOST - 1, MOST)
        self.demand("every number fits 32 bits", holds, node, state, call)
        return made

    def narrowed(self, a: Term, low: int, high: int) -> Term:
        """A term known to lie in a range, for those that its own range is too wide for."""
        if low <= a.low and a.high <= high:
            return a
        return self.terms.bits_and(a, self.terms.number(high))

    def apply(self, node: ast.Call, state: State, call: Call) -> Any:
        """A call: of min, max, abs, an action, a draw, or a function of the protocol."""
        assert isinstance(node.func, ast.Name)
        args = [self.value(arg, state, call) for arg in node.args]
        name = call.function.calls.get(node.func.id)
        if name is None:
            return self.plain(node, [self.terms.as_number(arg) for arg in args], call)
        function = self.functions.get(name)
        if function is None:
            raise ProveError(f"{self.place(node, call)}: {node.func.id} is not of the protocol")
        found = self.builtin(function, args, state, call)  # type: ignore[attr-defined]
        if found is not None:
            return found
        under = self.terms.all(call.under, state.path)
        store, found = self.call(function, args, state.store, under)  # type: ignore[attr-defined]
        state.store = store
        return found

    def plain(self, node: ast.Call, args: list[Term], call: Call) -> Term:
        """min, max or abs of numbers."""
        terms = self.terms
        name = node.func.id  # type: ignore[attr-defined]
        if name == "abs":
            zero = terms.number(0)
            return terms.pick(terms.less(args[0], zero), terms.sub(zero, args[0]), args[0])
        if name not in ("min", "max"):
            raise ProveError(f"{self.place(node, call)}: {name} is not of the dialect")
        found = args[0]
        for one in args[1:]:
            found = least(terms, found, one) if name == "min" else greatest(terms, found, one)
        return found


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
