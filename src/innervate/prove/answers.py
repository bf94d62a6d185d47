"""Functions that only look something up: whatever they answer, they answer the same again."""

import ast
from collections.abc import Iterable, Iterator
from typing import Any

from innervate.dialect.source import Function
from innervate.dialect.trees import every_node
from innervate.prove.errors import ProveError
from innervate.prove.execute import Machine
from innervate.prove.records import Outbox, Store
from innervate.prove.terms import Term, Terms


class Answers(Machine):
    """Takes the answers of some functions for any in their range, so that they need not be looked
    into. Two questions are the same where arguments are, and every field that is read.

    Args:
        asked: names of the functions; each may change nothing.
    """

    def __init__(
        self, functions: dict[str, Function], terms: Terms, out: Outbox, asked: Iterable[str]
    ) -> None:
        super().__init__(functions, terms, out)
        self.asked = {name: frozenset(self.read(functions[name])) for name in asked}
        self.given: list[tuple[str, list[Any], Store, Term]] = []
        self.ranges: dict[tuple[Any, ...], Term] = {}

    def read(self, function: Function) -> Iterator[str]:
        """Names of the fields that a function may read."""
        for node in every_node(function.node):
            if isinstance(node, ast.Attribute):
                yield node.attr
            elif isinstance(node, ast.Name) and node.id in function.calls:
                yield from self.read(self.functions[function.calls[node.id]])

    def call(
        self, function: Function, args: list[Any], store: Store, under: Term
    ) -> tuple[Store, Any]:
        """Follow a call; of one that is asked, the answer."""
        if function.name not in self.asked:
            return super().call(function, args, store, under)
        read = {key: value for key, value in store.items() if key[1] in self.asked[function.name]}
        range_ = self.range_of(function, args, store, read)
        answer = self.terms.fresh(function.name, range_.low, range_.high)
        for name, told, before, other in self.given:
            if name == function.name and before == read:
                same = self.terms.same(answer, other)
                self.facts.append(self.terms.implies(self.is_same(args, told), same))
        self.given.append((function.name, args, read, answer))
        return store, answer

    def range_of(self, function: Function, args: list[Any], store: Store, read: Store) -> Term:
        """What a function answers to any arguments of these ranges, for the range of that.

        It is seen to change nothing.
        """
        t = self.terms
        any_ = [t.unknown(f"{place}, {one.low} to {one.high}", one.low, one.high)
                if isinstance(one, Term) else one for place, one in enumerate(args)]  # fmt: skip
        seen = (function.name, *any_, *read.values())
        if seen not in self.ranges:
            inner = Machine(self.functions, t, Outbox((), 0))
            after, found = inner.call(function, any_, store, t.true)
            changes = any(after[key] is not value for key, value in store.items())
            if changes or inner.draws or inner.out.actions or not isinstance(found, Term):
                raise ProveError(f"{function.name} does more than to look something up")
            self.ranges[seen] = t.as_number(found)
        return self.ranges[seen]

    def is_same(self, args: list[Any], told: list[Any]) -> Term:
        """It is asked the same."""
        t, parts = self.terms, []
        for one, other in zip(args, told, strict=True):
            alike = isinstance(one, Term) and isinstance(other, Term)
            parts.append(t.same(one, other) if alike else t.truth_of(one is other))
        return t.all(*parts)
