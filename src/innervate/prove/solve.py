"""Asks the solver: bit vectors just as wide as each term's range wants.

The only door to z3, which is an extra.
"""

import threading
from collections.abc import Callable
from concurrent.futures import Future
from contextlib import suppress
from typing import Any

import z3
from z3 import z3core as core

from innervate.prove.errors import ProveError, UnsureError
from innervate.prove.terms import Term


def width_of(low: int, high: int) -> int:
    """Bits of a signed number of a range."""
    return max(high.bit_length(), (-low - 1).bit_length() if low < 0 else 0) + 1


class Formulas:
    """Terms as z3's formulas; each is made once.

    They are made by z3's own calls: its Python operators ask each operand for its sort again, which
    took longer than solving.
    """

    def __init__(self) -> None:
        self._made: dict[int, Any] = {}
        self._kept: list[Term] = []
        self.unknowns: dict[str, tuple[Term, Any]] = {}
        self._context = z3.main_ctx()
        self._ref = self._context.ref()

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

    def _make(self, term: Term) -> Any:
        op, args = term.op, term.args
        if term.is_truth:
            return z3.BoolRef(self._truth(op, args), self._context)
        width = width_of(term.low, term.high)
        if op == "const":
            return z3.BitVecVal(term.low, width)
        if op == "var":
            return self._unknown(term, width)
        if op == "pick":
            if_, a, b = (one for one in args if isinstance(one, Term))
            x, y = self._as_wide(a, width), self._as_wide(b, width)
            return self._bits(core.Z3_mk_ite(self._ref, self.of(if_).ast, x.ast, y.ast))
        a, b = (one for one in args if isinstance(one, Term))
        if op == "wrap":
            sum_ = self._both(core.Z3_mk_bvadd, self._as_wide(a, width), self._as_wide(b, width))
            return self._both(core.Z3_mk_bvand, sum_, z3.BitVecVal(args[2], width))
        most = max(width, *(width_of(one.low, one.high) for one in (a, b)))
        x, y = self._as_wide(a, most), self._as_wide(b, most)
        return self._cut(self._applied(op, x, y), most, width)

    def _bits(self, made: Any) -> Any:
        return z3.BitVecRef(made, self._context)

    def _both(self, make: Callable[..., Any], x: Any, y: Any) -> Any:
        return self._bits(make(self._ref, x.ast, y.ast))

    def _as_wide(self, term: Term, width: int) -> Any:
        """A number's formula with so many bits; higher ones are cut off."""
        made, own = self.of(term), width_of(term.low, term.high)
        if own < width:
            return self._bits(core.Z3_mk_sign_ext(self._ref, width - own, made.ast))
        return self._cut(made, own, width)

    def _cut(self, x: Any, own: int, width: int) -> Any:
        if own <= width:
            return x
        return self._bits(core.Z3_mk_extract(self._ref, width - 1, 0, x.ast))

    def _applied(self, op: str, x: Any, y: Any) -> Any:
        if op != "div":
            return self._both(OPERATIONS[op], x, y)
        quotient = x / y  # rounded down, of any dividend by one that is at least 1
        return z3.If(z3.SRem(x, y) < 0, quotient - 1, quotient)

    def _unknown(self, term: Term, width: int) -> Any:
        name = str(term.args[0])
        if name in self.unknowns:  # the solver would take both for one, in the range of the last
            raise ProveError(f"two unknowns are called {name}")
        if term.low >= 0:
            made = z3.ZeroExt(1, z3.BitVec(name, width - 1))
        else:
            made = z3.BitVec(name, width)
        self.unknowns[name] = (term, made)
        return made

    def _truth(self, op: str, args: tuple[object, ...]) -> Any:
        if op == "const":
            return z3.BoolVal(bool(args[0])).ast
        terms = [one for one in args if isinstance(one, Term)]
        if op in ("eq", "lt"):
            width = max(width_of(one.low, one.high) for one in terms)
            x, y = (self._as_wide(one, width) for one in terms)
            compare = core.Z3_mk_eq if op == "eq" else core.Z3_mk_bvslt
            return compare(self._ref, x.ast, y.ast)
        made = [self.of(one).ast for one in terms]
        if op == "not":
            return core.Z3_mk_not(self._ref, made[0])
        if op == "pick":
            return core.Z3_mk_ite(self._ref, *made)
        join = core.Z3_mk_and if op == "all" else core.Z3_mk_or
        return join(self._ref, len(made), (z3.Ast * len(made))(*made))

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


OPERATIONS: dict[str, Callable[..., Any]] = {
    "add": core.Z3_mk_bvadd,
    "sub": core.Z3_mk_bvsub,
    "mul": core.Z3_mk_bvmul,
    "mod": core.Z3_mk_bvsmod,  # of the divisor's sign, as Python's
    "and": core.Z3_mk_bvand,
    "or": core.Z3_mk_bvor,
    "xor": core.Z3_mk_bvxor,
    "shl": core.Z3_mk_bvshl,
    "shr": core.Z3_mk_bvashr,
}


STEPS_MAX = 2_000_000_000
BREAK_S = 0.02  # a solver that has been told to stop is told so again after that long


class Question:
    """Whether something can be, given what is known.

    Args:
        formulas: that all is made with.
        facts: what is known.
        steps_max: how much the solver may think of one answer; in its own steps, 5 to 20 million a
            second, so that a busy machine finds out the same.
    """

    def __init__(self, formulas: Formulas, facts: list[Term], steps_max: int = STEPS_MAX) -> None:
        self.formulas = formulas
        self.facts = facts
        self.steps_max = steps_max
        self.model: Any = None
        self.values_found: dict[str, int] = {}

    def values(self, *wanted: Term) -> dict[str, int] | None:
        """Values of all unknowns for which all of these hold; None if there are none.

        Raises:
            UnsureError: the solver could not say.
        """
        if not self._ask(self._solver(*map(self.formulas.of, wanted))):
            return None
        return self.found()

    def found(self) -> dict[str, int]:
        """Values of all unknowns in what was found last."""
        self.values_found = {
            name: _signed(self.model.eval(made, model_completion=True))
            for name, (_, made) in self.formulas.unknowns.items()
        }
        return self.values_found

    def together(self, terms: list[Term]) -> Callable[..., bool]:
        """Tells of some of these truths, by their places, whether they can be so at once.

        The solver is given all of them and keeps what it learns of some for the next.
        """
        asked = (z3.Implies(z3.Bool(f"asked {k}"), self.formulas.of(term))
                 for k, term in enumerate(terms))  # fmt: skip
        solver = self._solver(*asked)
        return lambda *places: self._ask(solver, *(z3.Bool(f"asked {k}") for k in places))

    def _solver(self, *wanted: Any) -> Any:
        known = [self.formulas.of(term) for term in self.facts]
        solver = z3.SolverFor("QF_BV")
        solver.set("rlimit", self.steps_max)
        solver.set("ctrl_c", False)  # the signal is for who waits for it
        solver.add(*known, *wanted, *self.formulas.ranges())
        return solver

    def _ask(self, solver: Any, *assumed: Any) -> bool:
        answer = self._answer(solver, assumed)
        if answer == z3.unsat:
            return False
        if answer != z3.sat:
            why = f"not within {self.steps_max:,} of its steps ({solver.reason_unknown()})"
            raise UnsureError(f"the solver could not say: {why}")
        self.model = solver.model()
        return True

    def _answer(self, solver: Any, assumed: tuple[Any, ...]) -> Any:
        """What the solver says; it thinks in a thread, as a signal is only heard outside of it."""
        said: Future[Any] = Future()

        def think() -> None:
            try:
                said.set_result(solver.check(*assumed))
            except Exception as error:
                said.set_exception(error)

        thread = threading.Thread(target=think)
        try:
            thread.start()
            thread.join()
        except KeyboardInterrupt:
            while thread.is_alive():  # what is let go of now it may still be thinking of
                with suppress(KeyboardInterrupt):
                    solver.ctx.interrupt()
                    thread.join(BREAK_S)
            raise
        return said.result()

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
