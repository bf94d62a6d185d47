"""What is known of numbers: which are never negative, and which are 0 or 1.

`//` and `%` of Python are those of C where nothing is negative; `and` and `or` where all is 0 or 1.
Found from the declared ranges by looking at all assignments, calls and returns until nothing more
has to be given up.
"""

from __future__ import annotations

import ast
from typing import NamedTuple

from innervate.dialect.trees import every_node
from innervate.firmware.program import Made, Program, Type


class Fact(NamedTuple):
    """Of a number: `natural`, it is never negative; `flag`, it is 0 or 1."""

    natural: bool
    flag: bool

    def meet(self, other: Fact) -> Fact:
        """What holds of both numbers."""
        return Fact(self.natural and other.natural, self.flag and other.flag)


ALL, NATURAL, NONE = Fact(True, True), Fact(True, False), Fact(False, False)


def _telling(made: Made) -> list[ast.AST]:
    """What of a function says something of numbers."""
    told = (ast.Assign, ast.AugAssign, ast.For, ast.Return, ast.Call)
    return [node for node in every_node(made.function.node) if isinstance(node, told)]


class Facts:
    """What is known of every variable and every function of a program."""

    def __init__(self, program: Program) -> None:
        self.program = program
        self.variables: dict[tuple[Made, str], Fact] = {}
        self.returned: dict[Made, Fact] = {}
        for handler in program.handlers:
            for name, kind in handler.types.items():
                if name in handler.arguments and kind.what == "int":
                    carrier = handler.name == "on_carrier" and name != "now"
                    self.variables[handler, name] = ALL if carrier else NATURAL
        self._nodes = {made: _telling(made) for made in program.functions()}
        self._changed = True
        while self._changed:
            self._changed = False
            for made in program.functions():
                self._look(made)

    def _look(self, made: Made) -> None:
        for node in self._nodes[made]:
            if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name):
                self._note(made, node.targets[0].id, self.of(made, node.value))
            elif isinstance(node, ast.AugAssign) and isinstance(node.target, ast.Name):
                whole = ast.BinOp(node.target, node.op, node.value)
                self._note(made, node.target.id, self.of(made, whole))
            elif isinstance(node, ast.For) and isinstance(node.iter, ast.Call):
                first = node.iter.args[0] if len(node.iter.args) == 2 else ast.Constant(0)
                assert isinstance(node.target, ast.Name)
                natural = self.of(made, first).natural
                self._note(made, node.target.id, Fact(natural, False))
            elif isinstance(node, ast.Return) and node.value is not None:
                old = self.returned.get(made, ALL)
                self._put(self.returned, made, old.meet(self.of(made, node.value)))
            elif isinstance(node, ast.Call) and node in made.calls:
                callee = made.calls[node]
                for name, argument in zip(callee.arguments, node.args, strict=True):
                    if callee.types[name] == Type("int"):
                        self._note(callee, name, self.of(made, argument))

    def _note(self, made: Made, name: str, fact: Fact) -> None:
        old = self.variables.get((made, name), ALL)
        self._put(self.variables, (made, name), old.meet(fact))

    def _put(self, table: dict, key: object, fact: Fact) -> None:  # type: ignore[type-arg]
        if table.get(key, ALL) != fact:
            self._changed = True
        table[key] = fact

    def of(self, made: Made, node: ast.expr) -> Fact:
        """What is known of an expression."""
        if isinstance(node, ast.Name) and (node.id in made.types):
            return self.variables.get((made, node.id), ALL)
        if isinstance(node, ast.Constant | ast.Name):
            value = made.function.constants[node.id] if isinstance(node, ast.Name) else node.value
            assert isinstance(value, int)
            return Fact(value >= 0, value in (0, 1))
        if isinstance(node, ast.Attribute | ast.Subscript):
            return self._field(made, node)
        if isinstance(node, ast.Compare):
            return ALL
        if isinstance(node, ast.UnaryOp):
            return ALL if isinstance(node.op, ast.Not) else NONE
        if isinstance(node, ast.BoolOp):
            return self._meet(made, node.values)
        if isinstance(node, ast.IfExp):
            return self._meet(made, [node.body, node.orelse])
        if isinstance(node, ast.BinOp):
            return self._binary(made, node)
        assert isinstance(node, ast.Call)
        return self._call(made, node)

    def _meet(self, made: Made, nodes: list[ast.expr]) -> Fact:
        found = ALL
        for node in nodes:
            found = found.meet(self.of(made, node))
        return found

    def _field(self, made: Made, node: ast.Attribute | ast.Subscript) -> Fact:
        place = node.value if isinstance(node, ast.Subscript) else node
        if isinstance(place, ast.Name):
            field = made.types[place.id].field  # an array that was passed
        elif isinstance(place, ast.Attribute):
            owner = self.owner(made, place.value)
            field = self.program.records.get(owner, {}).get(place.attr)
        else:
            return NONE
        if field is None:
            return NATURAL
        natural = field.low >= 0 and not self.program.role.wide  # or it may leave its range
        return Fact(natural, field.low >= 0 and field.high <= 1)

    def owner(self, made: Made, node: ast.expr) -> str:
        """The record that an expression is."""
        if isinstance(node, ast.Name):
            return made.types[node.id].what
        if isinstance(node, ast.Subscript) and isinstance(node.value, ast.Attribute):
            return node.value.attr  # out.frame[i], out.action[i]
        assert isinstance(node, ast.Call)
        return made.calls[node].returns.what

    def _binary(self, made: Made, node: ast.BinOp) -> Fact:
        left, right = self.of(made, node.left), self.of(made, node.right)
        both = left.natural and right.natural
        if isinstance(node.op, ast.BitAnd):
            either = left.natural or right.natural
            return Fact(either, left.flag or right.flag)
        if isinstance(node.op, ast.BitOr | ast.BitXor):
            return left.meet(right)
        if isinstance(node.op, ast.Add | ast.FloorDiv | ast.LShift):
            return Fact(both, False)
        if isinstance(node.op, ast.Mult):
            return Fact(both, left.flag and right.flag)
        if isinstance(node.op, ast.RShift):
            return Fact(left.natural, left.flag)
        if isinstance(node.op, ast.Mod):
            return Fact(right.natural, False)
        return NONE

    def _call(self, made: Made, node: ast.Call) -> Fact:
        if node in made.calls:
            return self.returned.get(made.calls[node], ALL)
        assert isinstance(node.func, ast.Name)
        facts = [self.of(made, argument) for argument in node.args]
        if node.func.id == "abs":
            return NATURAL
        if node.func.id == "max":
            return Fact(any(fact.natural for fact in facts), all(fact.flag for fact in facts))
        return self._meet(made, node.args)
