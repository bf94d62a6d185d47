"""Whether variables have a value wherever they are looked at: C takes any, Python raises."""

import ast
from collections.abc import Iterable, Iterator, Set

from innervate.dialect.trees import every_node

Given = Set[str] | None  # the variables with a value on every way; None = there is no way here


def without_value(function: ast.FunctionDef, names: Set[str]) -> ast.Name | None:
    """The first use of one of a function's own variables that on some way has no value."""
    body = _Body(names)
    body.block(function.body[1:], frozenset())
    return body.found


def _meet(ways: Iterable[Given]) -> Given:
    """What has a value whichever of these ways was taken."""
    there = [way for way in ways if way is not None]
    return frozenset(there[0]).intersection(*there[1:]) if there else None


class _Body:
    """Follows all ways through a function."""

    def __init__(self, names: Set[str]) -> None:
        self.names = names
        self.found: ast.Name | None = None
        self.breaks: list[Given] = []  # of the innermost loop

    def block(self, body: list[ast.stmt], given: Given) -> Given:
        """What has a value behind these statements."""
        for statement in body:
            if given is None:
                return None
            given = self._behind(statement, given)
        return given

    def _behind(self, node: ast.stmt, given: Set[str]) -> Given:
        if isinstance(node, ast.If):
            self._look(node.test, given)
            return _meet([self.block(node.body, given), self.block(node.orelse, given)])
        if isinstance(node, ast.While | ast.For):
            return self._loop(node, given)
        if isinstance(node, ast.Break):
            self.breaks.append(given)
        if isinstance(node, ast.AugAssign):
            self._look(node.target, given, (ast.Load, ast.Store))
        self._look(node, given)
        if isinstance(node, ast.Break | ast.Continue | ast.Return):
            return None
        return given | set(_stored(node))

    def _loop(self, node: ast.While | ast.For, given: Set[str]) -> Given:
        """Behind it: its test failed at once, or after a turn; or a break."""
        outer, self.breaks = self.breaks, []
        self._look(node.test if isinstance(node, ast.While) else node.iter, given)
        inside = given | set(_stored(node.target)) if isinstance(node, ast.For) else given
        self.block(node.body, inside)
        endless = isinstance(node, ast.While) and _is_true(node.test)
        found = _meet([None if endless else given, *self.breaks])
        self.breaks = outer
        return found

    def _look(self, node: ast.AST, given: Set[str], how: tuple[type, ...] = (ast.Load,)) -> None:
        for name in _names(node):
            if isinstance(name.ctx, how) and name.id in self.names - given:
                self.found = self.found or name


def _is_true(test: ast.expr) -> bool:
    return isinstance(test, ast.Constant) and bool(test.value)


def _names(node: ast.AST) -> Iterator[ast.Name]:
    return (inner for inner in every_node(node) if isinstance(inner, ast.Name))


def _stored(node: ast.AST) -> Iterator[str]:
    return (name.id for name in _names(node) if isinstance(name.ctx, ast.Store))
