"""A protocol's functions as C will have them: which arguments are records, which are changed.

Python says of no argument what it is; C has to. Types flow from the handlers, whose arguments are
known, through all calls. A function that is called with different records is made once for each.
"""

import ast
import copy
from collections.abc import Set
from typing import NamedTuple

from innervate.dialect import source
from innervate.dialect.trees import every_node
from innervate.firmware.errors import FirmwareError, Refused
from innervate.firmware.given import without_value
from innervate.firmware.records import TYPES, Field
from innervate.live.board import Role

BUILTINS = ("abs", "max", "min")
# What handlers are given between clock and outbox, in order of their numbers.
GIVEN = {
    "on_start": ("int",),
    "on_frame": ("int", "frame"),
    "on_timer": ("int",),
    "on_input": ("int", "item"),
    "on_carrier": ("int", "int"),
    "on_sent": ("int",),
}
OUT = ("count", "limit", "overflow")


class Type(NamedTuple):
    """What an expression is, in C's terms."""

    what: str  # "int", a record's name, "out", "array" of numbers, "actions", "frames", or "none"
    field: Field | None = None  # of an array, the field that it is

    @property
    def is_pointer(self) -> bool:
        """True for what C passes by its address."""
        return self.what not in ("int", "none")


INT, NOTHING = Type("int"), Type("none")


class Made:
    """A function as C has it.

    Attributes:
        name: in C, without the prefix.
        types: of its arguments and local variables, in order of appearance.
        returns: what it returns.
        changed: the arguments that are written through.
        roots: of a local record, the argument that it is part of.
        calls: what its calls are calls of.
        reads, writes: names of fields that it and what it calls look at, or change.
    """

    def __init__(self, function: source.Function, types: tuple[Type, ...]) -> None:
        self.function = function
        self.name = function.name
        self.arguments = [argument.arg for argument in function.node.args.args]
        self.types: dict[str, Type] = dict(zip(self.arguments, types, strict=True))
        self.returns = NOTHING
        self.changed: set[str] = set()
        self.roots = {name: name for name in self.arguments}
        self.calls: dict[ast.Call, Made] = {}
        self.reads: set[str] = set()
        self.writes: set[str] = set()

    def refuse(self, node: ast.AST, what: str) -> Refused:
        """The error that a line of it is."""
        return Refused(self.function.path, node, what)


class Program:
    """All functions that a role's handlers can reach, callees first.

    Raises:
        FirmwareError: something is outside the dialect.
    """

    def __init__(self, role: Role, records: dict[str, dict[str, Field]]) -> None:
        self.role, self.records = role, records
        self.sources = source.functions(role.entry, shared=True)
        for function in self.sources.values():
            function.node = _without(function.node, role.noted)
        self.made: dict[tuple[str, tuple[Type, ...]], Made] = {}
        self._open: list[tuple[str, tuple[Type, ...]]] = []
        # Handlers stand in the role's own module; what it calls may have such a name, too.
        own = {name for name, one in self.sources.items() if one.module == role.entry}
        self.handlers = [self._handler(name) for name in GIVEN if name in own]
        if not self.handlers:
            raise FirmwareError(f"{role.entry}: none of {', '.join(GIVEN)} stands in it")
        self._name_twins()

    def functions(self) -> list[Made]:
        """All of them, callees first."""
        return list(self.made.values())

    def _handler(self, name: str) -> Made:
        given = [self._record(what) for what in GIVEN[name]]
        gate = [Type("gate")] if self.role.has_gate else []
        types = [Type("state"), *gate, Type("params"), INT, *given, Type("out")]
        function = self.sources[name]
        if len(function.node.args.args) != len(types):
            what = f"{name} takes {len(types)} arguments, not {len(function.node.args.args)}"
            raise Refused(function.path, function.node, what)
        return self._instance(function, tuple(types))

    def _record(self, what: str) -> Type:
        if what == "item" and what not in self.records:
            return Type("frame")
        return Type(what)

    def _instance(self, function: source.Function, types: tuple[Type, ...]) -> Made:
        key = (function.name, types)
        if key in self.made:
            return self.made[key]
        if key in self._open:
            raise Refused(function.path, function.node, f"{function.name} calls itself")
        self._open.append(key)
        made = Made(function, types)
        _Reader(self, made).read()
        own = made.types.keys() - set(made.arguments)
        if (name := without_value(function.node, own)) is not None:
            raise made.refuse(name, f"{name.id} has no value here on some way; give it one before")
        self._open.pop()
        self.made[key] = made
        return made

    def instance(self, name: str, types: tuple[Type, ...], caller: Made, node: ast.Call) -> Made:
        """The function that a call is a call of."""
        function = self.sources[name]
        if len(function.node.args.args) != len(types):
            raise caller.refuse(node, f"{name} takes {len(function.node.args.args)} arguments")
        return self._instance(function, types)

    def _name_twins(self) -> None:
        """Functions that are made for several kinds of records are called after them, too."""
        names = [made.name for made in self.made.values()]
        for made in self.made.values():
            if names.count(made.name) > 1:
                kinds = [t.what for t in made.types.values() if t.what in ("frame", "item")]
                array = [t.field.type for t in made.types.values() if t.field is not None]
                made.name = "_".join([made.name, *(kinds or array)])


def _passed(kind: Type) -> Type:
    """An argument's type: of arrays that are passed, only the type of the numbers matters."""
    if kind.field is None:
        return kind
    low, high, _ = TYPES[kind.field.type]
    return Type("array", Field(kind.field.type, kind.field.type, 0, low, high, "", ""))


def array_of(made: Made, node: ast.expr) -> set[str]:
    """The name of the field that an argument is, if it is an array of a record."""
    if isinstance(node, ast.Attribute):
        return {node.attr}
    field = (
        made.types[node.id].field if isinstance(node, ast.Name) and node.id in made.types else None
    )
    return set() if field is None else {field.name}


def _without(function: ast.FunctionDef, noted: Set[str]) -> ast.FunctionDef:
    """A function less the assignments to fields that only a simulation fills in."""
    if not any(_is_noted(node, noted) for node in every_node(function)):
        return function
    function = copy.deepcopy(function)  # others have it, too
    for node in every_node(function):
        for name in ("body", "orelse"):
            body = getattr(node, name, None)
            if isinstance(body, list):
                body[:] = [inner for inner in body if not _is_noted(inner, noted)]
    return function


def _is_noted(node: ast.AST, noted: Set[str]) -> bool:
    targets = node.targets if isinstance(node, ast.Assign) else []
    return any(isinstance(target, ast.Attribute) and target.attr in noted for target in targets)


class _Reader:
    """Finds out types, and what is changed, in one function."""

    def __init__(self, program: Program, made: Made) -> None:
        self.program, self.made = program, made

    def read(self) -> None:
        self._block(self.made.function.node.body[1:])

    def _block(self, body: list[ast.stmt]) -> None:
        for statement in body:
            handle = getattr(self, f"_{type(statement).__name__}", None)
            if handle is None:
                what = f"{type(statement).__name__.lower()} is not in the dialect"
                raise self.made.refuse(statement, what)
            handle(statement)

    def _Assign(self, node: ast.Assign) -> None:
        (target,) = node.targets  # `with_numbers` has made an assignment each of several
        self._store(target, self.type(node.value), node.value)

    def _AugAssign(self, node: ast.AugAssign) -> None:
        whole = ast.copy_location(ast.BinOp(node.target, node.op, node.value), node)
        self._store(node.target, self.type(whole), node.value)

    def _store(self, target: ast.expr, kind: Type, value: ast.expr) -> None:
        made = self.made
        if not isinstance(target, ast.Name):
            if kind != INT or self.type(target) != INT:
                raise made.refuse(target, "only numbers are assigned to fields")
            self._change(target)
            return
        if kind == NOTHING:
            raise made.refuse(value, "the function called here returns nothing")
        if made.types.setdefault(target.id, kind) != kind:
            raise made.refuse(target, f"{target.id} is two different things")
        if kind.is_pointer:
            made.roots[target.id] = self.root(value)

    def _change(self, place: ast.expr) -> None:
        """A place is assigned to: the field that it is, of the argument that it is part of."""
        self.made.changed.add(self.root(place))
        inner = place.value if isinstance(place, ast.Subscript) else place
        if isinstance(inner, ast.Attribute):
            self.made.writes.add(inner.attr)
        elif isinstance(inner, ast.Name) and (field := self.made.types[inner.id].field):
            self.made.writes.add(field.name)

    def root(self, node: ast.expr) -> str:
        """The argument that a record or array is part of."""
        while isinstance(node, ast.Attribute | ast.Subscript):
            node = node.value
        if isinstance(node, ast.Call):
            called = self.made.calls[node]
            for name, argument in zip(called.arguments, node.args, strict=True):
                if called.types[name].what == "out":
                    return self.root(argument)
            raise self.made.refuse(node, "a record is returned that is not in the outbox")
        assert isinstance(node, ast.Name)
        found: str = self.made.roots.get(node.id, node.id)
        return found

    def _If(self, node: ast.If) -> None:
        self.type(node.test)
        self._block(node.body)
        self._block(node.orelse)

    def _While(self, node: ast.While) -> None:
        if node.orelse:
            raise self.made.refuse(node, "a while with an else")
        self.type(node.test)
        self._block(node.body)

    def _For(self, node: ast.For) -> None:
        loop = node.iter
        if not isinstance(loop, ast.Call) or not isinstance(loop.func, ast.Name):
            raise self.made.refuse(node, "a for over something that is no range")
        if loop.func.id != "range" or not 1 <= len(loop.args) <= 2:
            raise self.made.refuse(node, "a for over something that is no range of one or two")
        if node.orelse or not isinstance(node.target, ast.Name):
            raise self.made.refuse(node, "a for with an else, or with more than one variable")
        for argument in loop.args:
            self.type(argument)
        self._store(node.target, INT, loop)
        self._block(node.body)

    def _Expr(self, node: ast.Expr) -> None:
        if not isinstance(node.value, ast.Call):
            raise self.made.refuse(node, "a value that nobody uses")
        self.type(node.value)

    def _Return(self, node: ast.Return) -> None:
        made = self.made
        kind = NOTHING if node.value is None else self.type(node.value)
        if made.returns != NOTHING and NOTHING != kind != made.returns:
            raise made.refuse(node, "it returns two different things")
        if kind.what in ("array", "actions", "frames"):
            raise made.refuse(node, "an array is returned")
        if kind != NOTHING:
            made.returns = kind

    def _Pass(self, _node: ast.stmt) -> None:
        pass

    _Break = _Continue = _Pass

    def type(self, node: ast.expr) -> Type:
        """What an expression is; everything in it is looked at."""
        handle = getattr(self, f"_type_{type(node).__name__}", None)
        if handle is None:
            what = f"{type(node).__name__.lower()} is not in the dialect"
            raise self.made.refuse(node, what)
        found: Type = handle(node)
        return found

    def _type_Name(self, node: ast.Name) -> Type:
        known = self.made.types.get(node.id)
        if known is None and node.id not in self.made.function.constants:
            raise self.made.refuse(node, f"{node.id} is no constant and was given no value before")
        return known or INT

    def _type_Constant(self, node: ast.Constant) -> Type:
        if not isinstance(node.value, int) or abs(node.value) >= 1 << 31:
            raise self.made.refuse(node, f"{node.value!r} is no whole number of 32 bits")
        return INT

    def _type_Attribute(self, node: ast.Attribute) -> Type:
        self.made.reads.add(node.attr)
        owner = self.type(node.value)
        if owner.what == "out":
            if node.attr in ("action", "frame"):
                return Type(f"{node.attr}s")
            if node.attr in OUT:
                return Type("array", Field(node.attr, "uint8_t", 1, 0, 255, "", ""))
        field = self.program.records.get(owner.what, {}).get(node.attr)
        if field is None:
            raise self.made.refuse(node, f"{ast.unparse(node)}: no such field is declared")
        return Type("array", field) if field.length else INT

    def _type_Subscript(self, node: ast.Subscript) -> Type:
        owner = self.type(node.value)
        if owner.field is not None:
            self.made.reads.add(owner.field.name)
        if isinstance(node.slice, ast.Slice) or self.type(node.slice) != INT:
            raise self.made.refuse(node, "an index that is no number")
        parts = {"array": INT, "actions": Type("action"), "frames": Type("frame")}
        if owner.what not in parts:
            raise self.made.refuse(node, f"{ast.unparse(node.value)} is no array")
        return parts[owner.what]

    def _numbers(self, node: ast.expr, *parts: ast.expr) -> Type:
        for part in parts:
            if self.type(part) != INT:
                raise self.made.refuse(node, f"{ast.unparse(part)} is no number")
        return INT

    def _type_BinOp(self, node: ast.BinOp) -> Type:
        if isinstance(node.op, ast.Div | ast.Pow | ast.MatMult):
            raise self.made.refuse(node, f"{type(node.op).__name__.lower()} is not in the dialect")
        return self._numbers(node, node.left, node.right)

    def _type_UnaryOp(self, node: ast.UnaryOp) -> Type:
        return self._numbers(node, node.operand)

    def _type_BoolOp(self, node: ast.BoolOp) -> Type:
        return self._numbers(node, *node.values)

    def _type_Compare(self, node: ast.Compare) -> Type:
        if any(isinstance(op, ast.In | ast.NotIn | ast.Is | ast.IsNot) for op in node.ops):
            raise self.made.refuse(node, "`in` and `is` are not in the dialect")
        return self._numbers(node, node.left, *node.comparators)

    def _type_IfExp(self, node: ast.IfExp) -> Type:
        return self._numbers(node, node.test, node.body, node.orelse)

    def _type_Call(self, node: ast.Call) -> Type:
        made, called = self.made, node.func
        if node.keywords or any(isinstance(a, ast.Starred) for a in node.args):
            raise made.refuse(node, "a keyword or starred argument")
        if not isinstance(called, ast.Name):
            raise made.refuse(node, "calls something that is no name")
        if called.id in BUILTINS and called.id not in made.function.calls:
            return self._numbers(node, *node.args)
        name = made.function.calls.get(called.id, "")
        if name not in self.program.sources:
            raise made.refuse(node, f"{called.id} is no function of the protocol")
        types = tuple(_passed(self.type(argument)) for argument in node.args)
        callee = self.program.instance(name, types, made, node)
        made.calls[node] = callee
        for parameter, argument in zip(callee.arguments, node.args, strict=True):
            returned = callee.returns.is_pointer and callee.types[parameter].what == "out"
            made.reads |= array_of(made, argument)
            if parameter in callee.changed or returned:
                made.changed.add(self.root(argument))
                made.writes |= array_of(made, argument)
        made.reads |= callee.reads
        made.writes |= callee.writes
        return callee.returns
