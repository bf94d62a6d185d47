"""A loop by induction: any one of its passes is run, and what follows the last."""

import ast
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

from innervate.prove.errors import ProveError
from innervate.prove.execute import Machine
from innervate.prove.records import State
from innervate.prove.terms import Term, Terms


@dataclass(slots=True)
class Passes:
    """A loop that was run so; what holds at its head is for who runs it to say."""

    at: Term  # how many passes are done
    is_pass: Term  # there is one more; else what follows is run
    entered: State  # before the first
    head: State  # when so many are done
    passed: State  # when one more is

    def fits(self, terms: Terms) -> Term:
        """What is any value at the head is so in a range that the first has, and a pass keeps."""
        kept = []
        for state in (self.entered, self.passed):
            for mine, any_ in self._varied(state):
                holds = terms.within(mine, any_.low, any_.high)
                kept.append(terms.implies(state.path, holds))
        return terms.all(*kept)

    def missing(self) -> list[Any]:
        """What a pass changes though it is not any value at the head."""
        return [key for key, before, head, passed in self._rows(self.passed)
                if before is head and passed is not head]  # fmt: skip

    def _varied(self, state: State) -> Iterator[tuple[Term, Term]]:
        for _, before, head, mine in self._rows(state):
            if before is not head:
                yield mine, head

    def _rows(self, state: State) -> Iterator[tuple[Any, Any, Any, Any]]:
        for of in ("store", "names"):
            before, head, mine = (getattr(one, of) for one in (self.entered, self.head, state))
            for key, value in before.items():
                yield key, value, head[key], mine[key]


class Induction(Machine):
    """Runs the loop of a function as any of its passes.

    What holds before the first pass, and behind a pass wherever it held before it, holds behind the
    loop, too.
    """

    looped: str  # the function's name; it runs one loop, once
    vary: Callable[[State], None]  # gives whatever passes change any value
    passes: Passes  # of the loop, once it was run

    def loop(self, node: ast.For, state: State) -> State | None:
        """Any pass, from the head on; it goes on with what follows the last."""
        call = state.call
        if call.function.name != self.looped:
            return super().loop(node, state)
        t, whole, actions = self.terms, state.path, len(self.out.actions)
        assert isinstance(node.iter, ast.Call)
        count = t.as_number(self.value(node.iter.args[-1], state))
        if len(node.iter.args) != 1 or count.value is None:
            raise ProveError(f"{self.place(node, state)}: how many passes there are is not known")
        at = t.unknown("passes done", 0, count.value)
        is_pass, entered = t.less(at, count), state.fork(whole)
        self.vary(state)
        head, outer = state.fork(whole), self.enter(call)
        passed = self.one_pass(node, t.true, at, state.fork(t.all(whole, is_pass)))
        if passed is None or call.broken or len(self.out.actions) > actions:
            raise ProveError(f"{self.place(node, state)}: a pass acts, or ends the loop")
        call.broken, call.continued = outer
        self.passes = Passes(at, is_pass, entered, head, passed)
        if missing := self.passes.missing():
            raise ProveError(f"{self.place(node, state)}: a pass changes {missing[0]}, too")
        state.path = t.all(whole, t.negated(is_pass))
        return state
