"""One module from a protocol's files, for memories in which every byte counts.

The functions stay as they are written; what they do not need at run time goes: docstrings,
imports between the files, and names of constants, in whose place stand their values. Where two
files have a function of the same name, the later one's is called after its file.
"""

from __future__ import annotations

import ast
import importlib
import inspect
import operator
from collections.abc import Callable, Set
from types import ModuleType
from typing import Any

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


def reached(entry: str) -> list[ModuleType]:
    """The modules that a protocol's functions lie in, callees first; `entry` is its own."""
    found: list[ModuleType] = []

    def visit(module: ModuleType) -> None:
        for thing in vars(module).values():
            if inspect.isfunction(thing) and thing.__module__ != module.__name__:
                lower = importlib.import_module(thing.__module__)
                if lower not in found:
                    visit(lower)
        if module not in found:
            found.append(module)

    visit(importlib.import_module(entry))
    return found


def functions(*entries: str, noted: Set[str] = frozenset()) -> dict[str, str]:
    """Name and source of every function that the entries' functions can reach, callees first.

    Args:
        entries: modules with the five functions, like "innervate.networks.skin.protocol.cell".
        noted: fields that only a simulation fills in: assignments to them are left out.
    """
    modules: list[ModuleType] = []
    for entry in entries:
        modules += [module for module in reached(entry) if module not in modules]
    names = _names_of(modules)
    wanted = _called(modules, entries, names)
    found: dict[str, str] = {}
    for module in modules:
        for node in ast.parse(inspect.getsource(module)).body:
            if isinstance(node, ast.FunctionDef) and (module.__name__, node.name) in wanted:
                known = _values(module, names)
                node.name = names[module.__name__, node.name]
                node.body = node.body[1:] or [ast.Pass()]  # without its docstring
                made = ast.fix_missing_locations(_Unnoted(noted).visit(_Names(known).visit(node)))
                found[made.name] = ast.unparse(made)
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


def fixed(source: str, params: dict[str, int]) -> str:
    """The same source for given parameters, without what they rule out."""
    made = _Pruned().visit(_Fixed(params).visit(ast.parse(source)))
    return ast.unparse(ast.fix_missing_locations(made))


LETTERS = "abcdefghijklmnopqrstuvwxyz"


def short(i: int) -> str:
    """The i-th shortest name: a, b .. z, ba, bb ..; none is a word of the language."""
    name = LETTERS[i % 26]
    while i >= 26:
        i //= 26
        name = LETTERS[i % 26] + name
    return name if name not in ("as", "do", "if", "in", "is", "or", "eq", "id") else name + "_"


def shortened(source: str, renamed: dict[str, str]) -> str:
    """The same source with short names; `renamed` are those of functions and attributes."""
    return ast.unparse(_Short(renamed).visit(ast.parse(source)))


def one_text(*sources: str) -> str:
    """Modules of a board as one, those that others import first; whole numbers in capitals inlined.

    Imports between them must be of the form `from module import name`, and stand at the top.
    """
    known: dict[str, ast.expr] = {}
    body: list[ast.stmt] = []
    for source in sources:
        for node in ast.parse(source).body:
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


def _own(module: ModuleType) -> list[str]:
    return [
        name
        for name, thing in vars(module).items()
        if inspect.isfunction(thing) and thing.__module__ == module.__name__
    ]


def _names_of(modules: list[ModuleType]) -> dict[tuple[str, str], str]:
    """What (module, function) is called in the joined module; entries keep their names."""
    taken: set[str] = set()
    names = {}
    for module in reversed(modules):
        short = module.__name__.rpartition(".")[2]
        for name in _own(module):
            names[module.__name__, name] = new = f"{short}_{name}" if name in taken else name
            taken.add(new)
    return names


def _values(module: ModuleType, names: dict[tuple[str, str], str]) -> dict[str, ast.expr]:
    """What stands for the names that a module's functions use."""
    found: dict[str, ast.expr] = {}
    for name, thing in vars(module).items():
        if isinstance(thing, int) and name.isupper():
            found[name] = ast.parse(repr(int(thing)), mode="eval").body
        elif inspect.isfunction(thing):
            key = (thing.__module__, thing.__name__)
            if key in names:
                found[name] = ast.Name(names[key], ast.Load())
    return found


def _called(modules: list[ModuleType], entries: tuple[str, ...], names: Any) -> set[Any]:
    """(module, function) of the handlers and of all that they call, directly or not."""
    by_name = {module.__name__: module for module in modules}
    waiting = [
        (entry, name)
        for entry in entries
        for name in _own(by_name[entry])
        if name.startswith("on_") or len(entries) > 1
    ]
    found = set(waiting)
    while waiting:
        home, name = waiting.pop()
        module = by_name[home]
        code = getattr(module, name).__code__
        for used in code.co_names:
            thing = vars(module).get(used)
            if inspect.isfunction(thing):
                key = (thing.__module__, thing.__name__)
                if key not in found:
                    found.add(key)
                    waiting.append(key)
    return found
