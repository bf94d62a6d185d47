"""Runs functions of the dialect on terms: all their paths at once.

Paths part at an `if` and are merged behind it; loops are unrolled, calls followed. What a path must
keep (indices within arrays, numbers within 32 bits, room, bounds of loops) is noted as it goes.
"""

import ast
from collections.abc import Callable
from typing import Any

from innervate.dialect.outbox import DELIVER, REPORT, SEND, SET_TIMER
from innervate.dialect.source import Function
from innervate.prove.errors import ProveError
from innervate.prove.express import Expressions
from innervate.prove.records import (
    Action,
    Array,
    Call,
    Demand,
    Key,
    Outbox,
    Record,
    State,
    Store,
    each_of,
    either,
    merged,
    unknowns,
)
from innervate.prove.terms import Term, Terms

LOOP_MAX = 40  # passes of a loop whose number is not known
OUTBOX = "innervate.dialect.outbox"
RANDOM = "innervate.dialect.rng"
# Of a pass, by its number and the state before it: whether there is one, and the loop's variable.
Goes = Callable[[int, State], tuple[Term, Term | None]]


class Machine(Expressions):
    """Runs the functions of a protocol.

    Args:
        functions: of the dialect's `source.functions`.
        terms: that all is made of.
        out: the outbox that handlers are given.
    """

    def __init__(self, functions: dict[str, Function], terms: Terms, out: Outbox) -> None:
        self.functions = functions
        self.terms = terms
        self.out = out
        self.demands: list[Demand] = []  # what must hold for the handlers to be sound
        self.facts: list[Term] = []  # what is known of draws
        # what is drawn, out of how many, where: at each place that draws
        self.draws: list[tuple[Term, Term, Term]] = []
        # for every (function, line, taken) of an `if`, where it is taken so
        self.ways: dict[tuple[str, int, bool], list[Term]] = {}

    def run(self, name: str, args: list[Any], store: Store) -> tuple[Store, Any]:
        """Call a function by its joined name; the values afterwards, and what it returned.

        Whole numbers among its arguments are known ones.
        """
        given = [self.terms.number(arg) if isinstance(arg, int) else arg for arg in args]
        return self.call(self.functions[name], given, store, self.terms.true)

    def call(
        self, function: Function, args: list[Any], store: Store, under: Term
    ) -> tuple[Store, Any]:
        """Follow a call to its end."""
        terms = self.terms
        names = [arg.arg for arg in function.node.args.args]
        call = Call(function, under)
        state = State(dict(zip(names, args, strict=True)), dict(store), terms.true, call)
        end = self.block(function.node.body, state)
        if end is not None:
            call.returned.append((end, None))
        state, value = call.returned[-1]
        for before, result in reversed(call.returned[:-1]):
            value = either(terms, before.path, result, value)
            state = merged(terms, before.path, before, state, terms.true)
        return state.store, value

    # -- statements: each gives the state of the paths that go on behind it, or None

    def block(self, body: list[ast.stmt], state: State) -> State | None:
        """Run statements one after the other."""
        for statement in body:
            if state.path is self.terms.false:
                return None
            after = self.statement(statement, state)
            if after is None:
                return None
            state = after
        return state

    def statement(self, node: ast.stmt, state: State) -> State | None:
        """Run one statement on a state."""
        match node:
            case ast.Expr():
                if not isinstance(node.value, ast.Constant):
                    self.returned(node.value, state)
                return state
            case ast.Assign(targets=[target]):
                self.assign(target, self.value(node.value, state), state)
                return state
            case ast.AugAssign():
                self.renew(node, state)
                return state
            case ast.If():
                return self.branch(node, state)
            case ast.For():
                return self.loop(node, state)
            case ast.While():
                return self.repeat(node, state)
            case ast.Return():
                value = self.returned(node.value, state)
                state.call.returned.append((state, value))
                return None
            case ast.Break():
                state.call.broken.append(state)
                return None
            case ast.Continue():
                state.call.continued.append(state)
                return None
            case ast.Pass():
                return state
        raise ProveError(f"{self.place(node, state)}: the dialect has no such statement")

    def returned(self, node: ast.expr | None, state: State) -> Any:
        """The value of an expression that need have none: a call's that returns nothing."""
        if isinstance(node, ast.Call):
            return self.apply(node, state)
        return None if node is None else self.value(node, state)

    def branch(self, node: ast.If, state: State) -> State | None:
        """Run both ways of an `if` and merge them."""
        terms = self.terms
        test = self.truth(node.test, state)
        self.note(node, test, state)
        if test.op == "const":
            return self.block(node.body if test is terms.true else node.orelse, state)
        whole = state.path
        yes = terms.all(whole, test)
        no = terms.all(whole, terms.negated(test))
        other = state.fork(no)
        state.path = yes
        a, b = self.block(node.body, state), self.block(node.orelse, other)
        if a is None or b is None:
            return b if a is None else a
        both = whole if a.path is yes and b.path is no else terms.any(a.path, b.path)
        return merged(terms, test, a, b, both)

    def note(self, node: ast.If | ast.IfExp, test: Term, state: State) -> None:
        """Note where both ways of a branch are taken."""
        under = self.here(state)
        for taken, way in ((True, test), (False, self.terms.negated(test))):
            here = self.ways.setdefault((state.call.function.name, node.lineno, taken), [])
            here.append(self.terms.all(under, way))

    def loop(self, node: ast.For, state: State) -> State | None:
        """Unroll a loop over a range."""
        terms = self.terms
        first, last, step = self.ends_of(node, state)
        far = last.high - first.low if step > 0 else first.high - last.low
        passes = max(-(-far // abs(step)), 0)
        many = passes if last.value is not None else min(passes, LOOP_MAX)

        def goes(k: int, _: State) -> tuple[Term, Term]:
            at = terms.add(first, terms.number(k * step))
            return terms.less(at, last) if step > 0 else terms.less(last, at), at

        return self.unroll(node, many, passes > many, goes, state)

    def unroll(
        self, node: ast.For | ast.While, many: int, may_go_on: bool, goes: Goes, state: State,
    ) -> State | None:  # fmt: skip
        """So many passes of a loop, as long as it goes on; if it may then, it must not."""
        call = state.call
        outer = self.enter(call)
        after: State | None = state
        for k in range(many):
            test, at = goes(k, state)
            if test is self.terms.false:
                break
            after = self.one_pass(node, test, at, state)
            if after is None:
                break
            state = after
        else:
            if may_go_on:
                test, _ = goes(many, state)
                self.demand("a loop ends", self.terms.negated(test), node, state)
        return self.leave(outer, after, call)

    def ends_of(self, node: ast.For, state: State) -> tuple[Term, Term, int]:
        """Where a loop begins and ends, and by how much it goes on."""
        assert isinstance(node.iter, ast.Call)
        ends = [self.integer(arg, state) for arg in node.iter.args]
        if len(ends) == 1:
            return self.terms.number(0), ends[0], 1
        step = ends[2].value if len(ends) == 3 else 1
        if not step:
            raise ProveError(f"{self.place(node, state)}: by how much a loop goes on is not known")
        return ends[0], ends[1], step

    def repeat(self, node: ast.While, state: State) -> State | None:
        """Unroll a loop with a condition."""

        def goes(_: int, state: State) -> tuple[Term, None]:
            return self.truth(node.test, state), None

        return self.unroll(node, LOOP_MAX, True, goes, state)

    def one_pass(
        self, node: ast.For | ast.While, goes: Term, at: Term | None, state: State
    ) -> State | None:
        """One pass of a loop where it goes on; where it does not, it is left."""
        terms = self.terms
        call = state.call
        if goes is not terms.true:
            call.broken.append(state.fork(terms.all(state.path, terms.negated(goes))))
            state.path = terms.all(state.path, goes)
        if state.path is terms.false:
            return None
        if at is not None:
            assert isinstance(node, ast.For)
            assert isinstance(node.target, ast.Name)
            state.names[node.target.id] = at
        end = self.block(node.body, state)
        ends = [*call.continued, *([end] if end is not None else [])]
        call.continued = []
        return self.joined(ends)

    def enter(self, call: Call) -> tuple[list[State], list[State]]:
        """Begin a loop within whatever loop there is."""
        outer = call.broken, call.continued
        call.broken, call.continued = [], []
        return outer

    def leave(
        self, outer: tuple[list[State], list[State]], end: State | None, call: Call
    ) -> State | None:
        """End a loop: all paths that left it go on behind it."""
        ends = [*call.broken, *([end] if end is not None else [])]
        call.broken, call.continued = outer
        return self.joined(ends)

    def joined(self, states: list[State]) -> State | None:
        """One state of several whose paths exclude each other."""
        if not states:
            return None
        whole = states[-1]
        for before in reversed(states[:-1]):
            path = self.terms.any(before.path, whole.path)
            whole = merged(self.terms, before.path, before, whole, path)
        return whole

    def assign(self, target: ast.expr, value: Any, state: State) -> None:
        """Give a name or a place a value."""
        if isinstance(target, ast.Name):
            state.names[target.id] = value
            return
        if not isinstance(value, Term):
            what = f"{ast.unparse(target)} is set to what is no number"
            raise ProveError(f"{self.place(target, state)}: {what}")
        self.write_at(self.aimed(target, state), value, state)

    def renew(self, node: ast.AugAssign, state: State) -> None:
        """Change a name or a place by something; which place is asked once."""
        if isinstance(node.target, ast.Name):
            there = ast.Name(node.target.id, ast.Load(), lineno=node.lineno)
            old = self.integer(there, state)
            new = self.integer(node.value, state)
            state.names[node.target.id] = self.binary(node.op, old, new, node, state)
            return
        places = self.aimed(node.target, state)
        old = self.read_at(places, state)
        new = self.integer(node.value, state)
        self.write_at(places, self.binary(node.op, old, new, node, state), state)

    def aimed(self, target: ast.expr, state: State) -> list[tuple[Term, Key]]:
        """The places that a target may stand for, and where it does."""
        terms = self.terms
        found: list[tuple[Term, Key]] = []
        if isinstance(target, ast.Attribute):
            owner = self.value(target.value, state)
            for where, record in each_of(terms, owner, terms.true):
                if (record, target.attr, None) not in state.store:
                    what = f"{ast.unparse(target)} is no field that is declared"
                    raise ProveError(f"{self.place(target, state)}: {what}")
                found.append((where, (record, target.attr, None)))
            return found
        assert isinstance(target, ast.Subscript)
        array = self.value(target.value, state)
        index = self.integer(target.slice, state)
        for where, one in each_of(terms, array, terms.true):
            assert isinstance(one, Array)
            self.check_index(index, one.length, target, state)
            for k in range(max(index.low, 0), min(index.high, one.length - 1) + 1):
                here = terms.same(index, terms.number(k))
                found.append((terms.all(where, here), (one.record, one.name, k)))
        return found

    def read_at(self, places: list[tuple[Term, Key]], state: State) -> Term:
        """What stands at a place; of an index outside of its array, anything."""
        found = self.terms.number(0)
        for number, (where, key) in enumerate(places):
            one = state.store[key]
            found = one if not number else self.terms.pick(where, one, found)
        return found

    def write_at(self, places: list[tuple[Term, Key]], value: Term, state: State) -> None:
        """Let a number stand at a place."""
        terms = self.terms
        for where, key in places:
            state.store[key] = terms.pick(where, terms.as_number(value), state.store[key])

    # -- what stands for itself: actions and draws

    def builtin(self, function: Function, args: list[Any], state: State) -> Any:
        """An action, or any number that a draw may return; None if it is an ordinary function."""
        name = function.node.name
        if function.module == RANDOM and name == "draw":
            return self.draw(args[1], state)
        if function.module != OUTBOX:
            return None
        zero = self.terms.number(0)
        given = [self.terms.as_number(arg) for arg in args[1:]]
        kind = {"send": SEND, "set_timer": SET_TIMER, "deliver": DELIVER, "report": REPORT}[name]
        a, b, c = (*given, zero, zero)[:3]
        number = len(self.out.actions)
        frame = Record(f"out{number}", self.out.frame if kind in (SEND, DELIVER) else ())
        guard = self.here(state)
        state.store.update(unknowns(self.terms, frame))
        made = Action(kind, guard, a, b, c, frame, state.call.function.name)
        self.out.actions.append(made)
        return made

    def draw(self, many: Term, state: State) -> Term:
        """Any number below `many`, which must be at least 1."""
        many = self.terms.as_number(many)
        least = self.terms.at_most(self.terms.number(1), many)
        self.demand("what is drawn from is not empty", least, state.call.function.node, state)
        drawn = self.terms.fresh("drawn", 0, max(many.high - 1, 0))
        under = self.terms.all(self.here(state), least)
        self.facts.append(self.terms.implies(under, self.terms.less(drawn, many)))
        self.draws.append((drawn, many, under))
        return drawn
