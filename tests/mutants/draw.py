"""Faults that could be planted in the sources, and a seeded draw of them.

A fault is one small edit of the kind that slips through a review: an edge (`<` for `<=`), a number
next to the right one, a condition the other way round, a statement that is missing. Strings,
annotations and the looks of pictures (keyword arguments of drawing calls) are left alone, and so
are the protocols, whose mutants are the explorer's (`networks/*/verify`).
"""

from __future__ import annotations

import ast
import hashlib
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

SOURCES = Path("src/innervate")
ROOM_MIN = 10  # faults drawn in each room, if it has as many
LOOKS = {"plot"}  # rooms whose keyword arguments say how something looks
SWAPS = {
    ast.Lt: "<=", ast.LtE: "<", ast.Gt: ">=", ast.GtE: ">", ast.Eq: "!=", ast.NotEq: "==",
    ast.In: "not in", ast.NotIn: "in", ast.Is: "is not", ast.IsNot: "is",
    ast.Add: "-", ast.Sub: "+", ast.Mult: "+", ast.Div: "*", ast.FloorDiv: "*", ast.Mod: "//",
    ast.LShift: ">>", ast.RShift: "<<", ast.BitAnd: "|", ast.BitOr: "&",
    ast.And: "or", ast.Or: "and",
}  # fmt: skip
CALLS = {"min": "max", "max": "min", "any": "all", "all": "any"}


class Fault(NamedTuple):
    """One edit: the bytes from `start` to `end` of a file become `new`.

    Attributes:
        text: the line, without indentation.
        nth: of several with the same text, old and new.
    """

    path: str
    line: int
    start: int
    end: int
    old: str
    new: str
    text: str = ""
    nth: int = 0

    @property
    def key(self) -> tuple[str, str, str, str, int]:
        """What it is known by, wherever in the file the line has moved."""
        return self.path, self.text, self.old, self.new, self.nth

    @property
    def room(self) -> str:
        """The room of the house that the file lies in; those of networks count with the spine's."""
        parts = Path(self.path).relative_to(SOURCES).parts
        inner = parts[2:] if parts[0] == "networks" else parts
        return inner[0] if len(inner) > 1 else "records"

    def __str__(self) -> str:
        return f"{self.path}:{self.line}: {self.old!r} -> {self.new!r}"


def drawn(root: Path, seed: int, count: int) -> list[Fault]:
    """Faults drawn over all rooms: some in each, the others by the rooms' size.

    An edit of the sources changes the draw only there.
    """
    every = [
        fault
        for path in sorted((root / SOURCES).rglob("*.py"))
        if "protocol" not in path.parts and "dialect" not in path.parts
        for fault in faults(path, path.relative_to(root).as_posix())
    ]
    every.sort(key=lambda fault: hashlib.blake2b(f"{seed} {fault.key}".encode()).digest())
    in_room = Counter[str]()
    first, rest = [], []
    for fault in every:
        in_room[fault.room] += 1
        (first if in_room[fault.room] <= ROOM_MIN else rest).append(fault)
    return (first + rest)[:count]


def faults(path: Path, name: str) -> list[Fault]:
    """All faults that could be planted in a file."""
    return Finder(path.read_bytes(), name).found()


class Finder:
    """Looks for places in one file.

    Args:
        source: what is in the file.
        name: what it is called in faults.
    """

    def __init__(self, source: bytes, name: str) -> None:
        self.source, self.name = source, name
        self._starts = [0]
        for line in source.splitlines(keepends=True):
            self._starts.append(self._starts[-1] + len(line))
        self._looks = any(room in Path(name).parts for room in LOOKS)

    def found(self) -> list[Fault]:
        """Every fault of the file, in order of places."""
        bare = sorted(self._in(ast.parse(self.source)), key=lambda fault: (fault.start, fault.new))
        lines = self.source.decode().splitlines()
        same = Counter[tuple[str, ...]]()
        made = []
        for fault in bare:
            text = lines[fault.line - 1].strip()
            kind = (text, fault.old, fault.new)
            made.append(fault._replace(text=text, nth=same[kind]))
            same[kind] += 1
        return made

    def _in(self, node: ast.AST) -> Iterator[Fault]:
        yield from self._of(node)
        for child in self._children(node):
            yield from self._in(child)

    def _children(self, node: ast.AST) -> Iterator[ast.AST]:
        """What may be changed below a node: no annotations, decorators, strings, type aliases."""
        if isinstance(node, ast.JoinedStr):
            return
        for field, value in ast.iter_fields(node):
            if field in ("annotation", "returns", "decorator_list", "type_params", "bases"):
                continue
            if field == "keywords" and (self._looks or isinstance(node, ast.ClassDef)):
                continue
            for child in value if isinstance(value, list) else [value]:
                if isinstance(child, ast.AST) and not is_for_types(child):
                    yield child

    def _of(self, node: ast.AST) -> Iterator[Fault]:
        if isinstance(node, ast.Compare):
            places = [node.left, *node.comparators]
            for before, swap, after in zip(places, node.ops, places[1:], strict=False):
                yield self._between(before, after, SWAPS[type(swap)])
        elif isinstance(node, ast.BinOp) and type(node.op) in SWAPS and not is_text(node):
            yield self._between(node.left, node.right, SWAPS[type(node.op)])
        elif isinstance(node, ast.BoolOp):
            for before, after in zip(node.values, node.values[1:], strict=False):
                yield self._between(before, after, SWAPS[type(node.op)])
        elif isinstance(node, ast.AugAssign) and type(node.op) in SWAPS:
            yield self._between(node.target, node.value, SWAPS[type(node.op)] + "=")
            yield self._whole(node, "pass")
        elif isinstance(node, ast.Constant):
            yield from self._number(node)
        elif isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.Not):
            yield self._whole(node, f"bool({self._text(node.operand)})")
        elif isinstance(node, ast.If | ast.While | ast.IfExp):
            yield self._whole(node.test, f"not ({self._text(node.test)})")
        elif isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
            if node.func.id in CALLS:
                yield self._whole(node.func, CALLS[node.func.id])
        elif is_left_out(node):
            yield self._whole(node, "pass")

    def _number(self, node: ast.Constant) -> Iterator[Fault]:
        value = node.value
        if isinstance(value, bool):
            yield self._whole(node, repr(not value))
        elif isinstance(value, int):
            yield self._whole(node, repr(value + 1))
            if value > 1:
                yield self._whole(node, repr(value - 1))
        elif isinstance(value, float):
            yield self._whole(node, repr(2 * value if value else 1.0))

    def _place(self, line: int, column: int) -> int:
        return self._starts[line - 1] + column

    def _text(self, node: ast.expr) -> str:
        start, end = self._span(node)
        return self.source[start:end].decode()

    def _span(self, node: ast.expr | ast.stmt) -> tuple[int, int]:
        assert node.end_lineno is not None
        assert node.end_col_offset is not None
        return (
            self._place(node.lineno, node.col_offset),
            self._place(node.end_lineno, node.end_col_offset),
        )

    def _whole(self, node: ast.expr | ast.stmt, new: str) -> Fault:
        start, end = self._span(node)
        return Fault(self.name, node.lineno, start, end, self.source[start:end].decode(), new)

    def _between(self, before: ast.expr, after: ast.expr, new: str) -> Fault:
        """The operator between two operands, which may stand in brackets of their own."""
        start, end = self._span(before)[1], self._span(after)[0]
        gap = self.source[start:end].decode()
        old = gap.strip("() \t\r\n\\")
        start += len(gap[: gap.index(old)].encode())
        line = before.end_lineno or before.lineno
        return Fault(self.name, line, start, start + len(old.encode()), old, new)


def is_left_out(node: ast.AST) -> bool:
    """True for statements that a fault leaves out: calls, raises, jumps, attributes set."""
    if isinstance(node, ast.Expr):
        return isinstance(node.value, ast.Call | ast.Await)
    if isinstance(node, ast.Assign):
        return isinstance(node.targets[0], ast.Attribute | ast.Subscript)
    return isinstance(node, ast.Raise | ast.Break | ast.Continue | ast.Delete)


def is_for_types(node: ast.AST) -> bool:
    """True for what only type checkers and readers look at."""
    if isinstance(node, ast.If) and "TYPE_CHECKING" in ast.unparse(node.test):
        return True
    names = {one.id for one in getattr(node, "targets", []) if isinstance(one, ast.Name)}
    if "__all__" in names:
        return True
    value = getattr(node, "value", None)
    return bool(names) and isinstance(value, ast.Subscript) and "Callable" in ast.unparse(value)


def is_text(node: ast.BinOp) -> bool:
    """True for what is put together of strings, and for unions of types."""
    if isinstance(node.op, ast.BitOr):
        return any(
            isinstance(one, ast.Constant) and one.value is None for one in (node.left, node.right)
        )
    return any(
        isinstance(one, ast.JoinedStr)
        or (isinstance(one, ast.Constant) and isinstance(one.value, str))
        for one in (node.left, node.right)
    )
