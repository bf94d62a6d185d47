"""One module from a protocol's files, for memories in which every byte counts.

The functions stay as they are written; what they do not need at run time goes: docstrings,
imports between the files, and names of constants, in whose place stand their values. Where two
files have a function of the same name, the later one's is called after its file.
"""

from __future__ import annotations

import ast
import operator
from collections.abc import Callable, Set
from typing import Any

from innervate.dialect import source

_COMPARE: dict[type, Callable[[Any, Any], bool]] = {
    ast.Eq: operator.eq, ast.NotEq: operator.ne, ast.Lt: operator.lt, ast.LtE: operator.le,
    ast.Gt: operator.gt, ast.GtE: operator.ge,
}  # fmt: skip
HEADER = "# Made from {}: see boards/join.py.\n"


class _Names(ast.NodeTransformer):
    """Puts values for constants, and the joined module's names for functions."""

    def __init__(self, names: dict[str, ast.expr]) -> None:
        self.names = names

    def visit_Name(self, node: ast.Name) -> ast.expr:
        found = self.names.get(node.id)
        if found is None:
            return node
        assert isinstance(node.ctx, ast.Load), f"{node.id} is a constant, and assigned to"
        return found


def functions(*entries: str, noted: Set[str] = frozenset()) -> dict[str, str]:
    """Name and source of every function that the entries' functions can reach, callees first.

    Args:
        entries: modules with the five functions, like "innervate.networks.skin.protocol.cell".
        noted: fields that only a simulation fills in: assignments to them are left out.
    """
    found: dict[str, str] = {}
    for name, function in source.functions(*entries).items():
        node = function.node
        node.name = name
        node.body = node.body[1:] or [ast.Pass()]  # without its docstring
        known: dict[str, ast.expr] = {
            constant: ast.parse(repr(value), mode="eval").body
            for constant, value in function.constants.items()
        }
        known |= {called: ast.Name(new, ast.Load()) for called, new in function.calls.items()}
        made = ast.fix_missing_locations(_Unnoted(noted).visit(_Names(known).visit(node)))
        found[name] = ast.unparse(made)
    return found


def joined(*entries: str, noted: Set[str] = frozenset()) -> str:
    """The same as the text of one module."""
    found = functions(*entries, noted=noted)
    return HEADER.format(", ".join(entries)) + "\n".join(found.values()) + "\n"


class _Unnoted(ast.NodeTransformer):
    """Leaves out assignments to fields that only a simulation fills in."""

    def __init__(self, noted: Set[str]) -> None:
        self.noted = noted

    def visit_Assign(self, node: ast.Assign) -> Any:
        (target,) = node.targets
        noted = isinstance(target, ast.Attribute) and target.attr in self.noted
        return None if noted else node


class _Short(ast.NodeTransformer):
    """Gives short names to local variables, and to what `renamed` has: functions, attributes."""

    def __init__(self, renamed: dict[str, str]) -> None:
        self.renamed = renamed
        self.local: dict[str, str] = {}

    def visit_FunctionDef(self, node: ast.FunctionDef) -> ast.FunctionDef:
        names = [arg.arg for arg in node.args.args]
        for inner in ast.walk(node):
            if isinstance(inner, ast.Name) and isinstance(inner.ctx, ast.Store):
                names.append(inner.id)
        self.local = {name: short(i) for i, name in enumerate(dict.fromkeys(names))}
        for arg in node.args.args:
            arg.arg = self.local[arg.arg]
        node.name = self.renamed.get(node.name, node.name)
        self.generic_visit(node)
        return node

    def visit_Name(self, node: ast.Name) -> ast.Name:
        found = self.local.get(node.id) or self.renamed.get(node.id, node.id)
        return ast.copy_location(ast.Name(found, node.ctx), node)

    def visit_Attribute(self, node: ast.Attribute) -> ast.Attribute:
        self.generic_visit(node)
        node.attr = self.renamed.get(node.attr, node.attr)
        return node


class _Fixed(ast.NodeTransformer):
    """Puts numbers for the attributes of `params`; only handlers are still given it."""

    def __init__(self, params: dict[str, int]) -> None:
        self.params = params

    def visit_Attribute(self, node: ast.Attribute) -> ast.expr:
        if isinstance(node.value, ast.Name) and node.value.id == "params":
            return ast.copy_location(ast.Constant(self.params[node.attr]), node)
        self.generic_visit(node)
        return node

    def visit_FunctionDef(self, node: ast.FunctionDef) -> ast.FunctionDef:
        if not node.name.startswith("on_"):
            node.args.args = [arg for arg in node.args.args if arg.arg != "params"]
        self.generic_visit(node)
        return node

    def visit_Call(self, node: ast.Call) -> ast.Call:
        node.args = [a for a in node.args if not isinstance(a, ast.Name) or a.id != "params"]
        self.generic_visit(node)
        return node


class _Pruned(ast.NodeTransformer):
    """Leaves out what constants decide: branches never taken, conditions that are known."""

    def visit_Compare(self, node: ast.Compare) -> ast.expr:
        self.generic_visit(node)
        if len(node.ops) == 1 and isinstance(node.left, ast.Constant):
            right, compare = node.comparators[0], _COMPARE.get(type(node.ops[0]))
            if isinstance(right, ast.Constant) and compare is not None:
                return ast.Constant(bool(compare(node.left.value, right.value)))
        return node

    def visit_BoolOp(self, node: ast.BoolOp) -> ast.expr:
        self.generic_visit(node)
        decides = isinstance(node.op, ast.Or)  # `x or True`, `x and False`
        left: list[ast.expr] = []
        for value in node.values:
            if not isinstance(value, ast.Constant):
                left.append(value)
            elif bool(value.value) is decides:
                left.append(value)
                break
        if not left:
            return ast.Constant(not decides)
        node.values = left
        return node if len(left) > 1 else left[0]

    def visit_IfExp(self, node: ast.IfExp) -> ast.expr:
        self.generic_visit(node)
        if isinstance(node.test, ast.Constant):
            return node.body if node.test.value else node.orelse
        return node

    def visit_If(self, node: ast.If) -> Any:
        self.generic_visit(node)
        if isinstance(node.test, ast.Constant):
            return (node.body if node.test.value else node.orelse) or ast.Pass()
        return node


def fixed(text: str, params: dict[str, int]) -> str:
    """The same source for given parameters, without what they rule out."""
    made = _Pruned().visit(_Fixed(params).visit(ast.parse(text)))
    return ast.unparse(ast.fix_missing_locations(made))


LETTERS = "abcdefghijklmnopqrstuvwxyz"


def short(i: int) -> str:
    """The i-th shortest name: a, b .. z, ba, bb ..; none is a word of the language."""
    name = LETTERS[i % 26]
    while i >= 26:
        i //= 26
        name = LETTERS[i % 26] + name
    return name if name not in ("as", "do", "if", "in", "is", "or", "eq", "id") else name + "_"


def shortened(text: str, renamed: dict[str, str]) -> str:
    """The same source with short names; `renamed` are those of functions and attributes."""
    return ast.unparse(_Short(renamed).visit(ast.parse(text)))


def one_text(*sources: str) -> str:
    """Modules of a board as one, those that others import first; whole numbers in capitals inlined.

    Imports between them must be of the form `from module import name`, and stand at the top.
    """
    known: dict[str, ast.expr] = {}
    body: list[ast.stmt] = []
    for text in sources:
        for node in ast.parse(text).body:
            if isinstance(node, ast.Assign) and isinstance(node.value, ast.Constant):
                (name,) = node.targets
                if isinstance(name, ast.Name) and name.id.isupper():
                    known[name.id] = node.value
                    continue
            body.append(node)
    module = ast.Module([node for node in body if not _is_noise(node)], [])
    return ast.unparse(ast.fix_missing_locations(_Names(known).visit(module))) + "\n"


def _is_noise(node: ast.stmt) -> bool:
    """True for a docstring, and for an import of what now stands in the same module."""
    if isinstance(node, ast.ImportFrom):
        return node.module in ("outbox", "replay")
    return isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)
