"""Asks the solver: bit vectors just as wide as each term's range wants.

The only door to z3, which is an extra.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import z3

from innervate.prove.errors import ProveError
from innervate.prove.terms import Term


def width_of(low: int, high: int) -> int:
    """Bits of a signed number of a range."""
    return max(high.bit_length(), (-low - 1).bit_length() if low < 0 else 0) + 1


class Formulas:
    """Terms as z3's formulas; each is made once."""

    def __init__(self) -> None:
        self._made: dict[int, Any] = {}
        self._kept: list[Term] = []
        self.unknowns: dict[str, tuple[Term, Any]] = {}

    def of(self, term: Term) -> Any:
        """The formula of a term: a Bool of a truth, else a bit vector of its width, signed."""
        made = self._made
        waiting = [term]
        while waiting:
            top = waiting[-1]
            if id(top) in made:
                waiting.pop()
                continue
            missing = [a for a in top.args if isinstance(a, Term) and id(a) not in made]
            if missing:
                waiting.extend(missing)
                continue
            made[id(top)] = self._make(top)
            self._kept.append(top)
            waiting.pop()
        return made[id(term)]

    def wide(self, term: Term, width: int) -> Any:
        """A number's formula with so many bits at least as it needs."""
        made = self.of(term)
        more = width - made.size()
        return z3.SignExt(more, made) if more > 0 else made

    def _make(self, term: Term) -> Any:
        op, args = term.op, term.args
        if term.is_truth:
            return self._truth(op, args)
        width = width_of(term.low, term.high)
        if op == "const":
            return z3.BitVecVal(term.low, width)
        if op == "var":
            return self._unknown(term, width)
        if op == "pick":
            return self._pick(args, width)
        if op == "wrap":
            return self._wrap(args, width)
        a, b = args
        assert isinstance(a, Term)
        assert isinstance(b, Term)
        most = max(width, width_of(a.low, a.high), width_of(b.low, b.high))
        x, y = self.wide(a, most), self.wide(b, most)
        return _cut(OPERATIONS[op](x, y), width)

    def _pick(self, args: tuple[object, ...], width: int) -> Any:
        if_, a, b = args
        assert isinstance(if_, Term)
        assert isinstance(a, Term)
        assert isinstance(b, Term)
        x, y = _cut(self.wide(a, width), width), _cut(self.wide(b, width), width)
        return z3.If(self.of(if_), x, y)

    def _wrap(self, args: tuple[object, ...], width: int) -> Any:
        base, ahead, mask = args
        assert isinstance(base, Term)
        assert isinstance(ahead, Term)
        return _cut(self.wide(base, width), width) + _cut(self.wide(ahead, width), width) & mask

    def _unknown(self, term: Term, width: int) -> Any:
        name = str(term.args[0])
        if term.low >= 0:
            made = z3.ZeroExt(1, z3.BitVec(name, width - 1))
        else:
            made = z3.BitVec(name, width)
        self.unknowns[name] = (term, made)
        return made

    def _truth(self, op: str, args: tuple[object, ...]) -> Any:
        if op == "const":
            return z3.BoolVal(bool(args[0]))
        made = [self.of(a) for a in args if isinstance(a, Term)]
        if op in ("eq", "lt"):
            width = max(one.size() for one in made)
            x, y = (z3.SignExt(width - one.size(), one) if one.size() < width else one
                    for one in made)  # fmt: skip
            return x == y if op == "eq" else x < y
        if op == "not":
            return z3.Not(made[0])
        if op == "pick":
            return z3.If(*made)
        return z3.And(*made) if op == "all" else z3.Or(*made)

    def ranges(self) -> list[Any]:
        """That every unknown lies in its range, where its width does not say so."""
        found = []
        for term, made in self.unknowns.values():
            bits = width_of(term.low, term.high) - 1
            if term.high != (1 << bits) - 1:
                found.append(made <= term.high)
            if term.low != (0 if term.low >= 0 else -(1 << bits)):
                found.append(made >= term.low)
        return found


def _cut(x: Any, width: int) -> Any:
    return z3.Extract(width - 1, 0, x) if x.size() > width else x


def _div(x: Any, y: Any) -> Any:
    """Rounded down, of any dividend by one that is at least 1."""
    quotient = x / y
    return z3.If(z3.SRem(x, y) < 0, quotient - 1, quotient)


OPERATIONS: dict[str, Callable[[Any, Any], Any]] = {
    "add": lambda x, y: x + y,
    "sub": lambda x, y: x - y,
    "mul": lambda x, y: x * y,
    "div": _div,
    "mod": lambda x, y: x % y,  # of the divisor's sign, as Python's
    "and": lambda x, y: x & y,
    "or": lambda x, y: x | y,
    "xor": lambda x, y: x ^ y,
    "shl": lambda x, y: x << y,
    "shr": lambda x, y: x >> y,
}


class Question:
    """Whether something can be, given what is known.

    Args:
        formulas: that all is made with.
        facts: what is known.
        limit_s: how long the solver may think of one answer.
    """

    def __init__(self, formulas: Formulas, facts: list[Term], limit_s: float = 120) -> None:
        self.formulas = formulas
        self.facts = facts
        self.limit_ms = round(1000 * limit_s)
        self.model: Any = None
        self.values_found: dict[str, int] = {}

    def values(self, *wanted: Term) -> dict[str, int] | None:
        """Values of all unknowns for which all of these hold; None if there are none.

        Raises:
            ProveError: the solver could not say.
        """
        made = [self.formulas.of(term) for term in (*self.facts, *wanted)]
        solver = z3.SolverFor("QF_BV")
        solver.set("timeout", self.limit_ms)
        solver.add(*made, *self.formulas.ranges())
        answer = solver.check()
        if answer == z3.unsat:
            return None
        if answer != z3.sat:
            raise ProveError(f"the solver could not say: {solver.reason_unknown()}")
        model = solver.model()
        self.model = model
        self.values_found = {
            name: _signed(model.eval(made, model_completion=True))
            for name, (_, made) in self.formulas.unknowns.items()
        }
        return self.values_found

    def holds(self, term: Term) -> bool:
        """If a truth holds for the values that were found last."""
        return bool(z3.is_true(self.model.eval(self.formulas.of(term), model_completion=True)))

    def which(self, terms: list[Term]) -> list[bool]:
        """Which truths hold for the values that were found last, all asked at once."""
        if len(terms) < 2:
            return [self.holds(term) for term in terms]
        bits = [z3.If(self.formulas.of(term), z3.BitVecVal(1, 1), z3.BitVecVal(0, 1))
                for term in terms]  # fmt: skip
        found = self.model.eval(z3.Concat(*bits), model_completion=True).as_long()
        return [bool(found >> place & 1) for place in reversed(range(len(terms)))]

    def value(self, term: Term) -> int:
        """A number for the values that were found last."""
        return _signed(self.model.eval(self.formulas.of(term), model_completion=True))


def _signed(value: Any) -> int:
    found: int = value.as_signed_long()
    return found
