"""Expressions of a protocol as C has them."""

import ast

from innervate.dialect.trees import every_node
from innervate.firmware.facts import Facts
from innervate.firmware.program import BUILTINS, OUT, Made, Program, array_of
from innervate.firmware.records import Field, name_of

BINARY = {
    ast.Add: "+", ast.Sub: "-", ast.Mult: "*", ast.LShift: "<<", ast.RShift: ">>",
    ast.BitAnd: "&", ast.BitOr: "|", ast.BitXor: "^", ast.FloorDiv: "/", ast.Mod: "%",
}  # fmt: skip
COMPARE = {
    ast.Eq: "==", ast.NotEq: "!=", ast.Lt: "<", ast.LtE: "<=", ast.Gt: ">", ast.GtE: ">=",
}  # fmt: skip
# How tightly text holds together; what C compilers want in parentheses is in them.
ATOM, UNARY, TIMES, PLUS, BITS, ORDER, AND, OR, CHOICE = range(9)
UNKNOWN = "_"  # Python's name for what nobody looks at


class Expressions:
    """Writes the expressions of one function.

    Attributes:
        constants: those with names that occurred.
        helpers: names of those that occurred.
    """

    def __init__(self, program: Program, facts: Facts, made: Made, names: dict[str, str]) -> None:
        self.program, self.facts, self.made = program, facts, made
        self.prefix = names[""]
        self.names = names
        self.constants: dict[str, int] = {}
        self.helpers: set[str] = set()

    def text(self, node: ast.expr, outer: int = CHOICE, as_test: bool = False) -> str:
        """An expression within one that holds together as `outer`.

        `as_test` is True where only zero or not matters.
        """
        if isinstance(node, ast.BoolOp | ast.UnaryOp | ast.IfExp):
            handle = getattr(self, f"_{type(node).__name__}")
            text, level = handle(node, as_test)
        else:
            text, level = getattr(self, f"_{type(node).__name__}")(node)
        return f"({text})" if level > outer else text

    def helper(self, name: str) -> str:
        """A helper's name in C; it is noted that it is needed."""
        self.helpers.add(name)
        return f"{self.prefix}_{name}"

    def _Name(self, node: ast.Name) -> tuple[str, int]:
        if node.id in self.made.types:
            return local(node.id), ATOM
        value = self.made.function.constants[node.id]
        name = self.names[f"{self.made.function.module}.{node.id}"]
        self.constants[node.id] = value
        return name, ATOM

    def _Constant(self, node: ast.Constant) -> tuple[str, int]:
        return str(int(node.value)), ATOM  # type: ignore[arg-type]

    def _Attribute(self, node: ast.Attribute) -> tuple[str, int]:
        if isinstance(node.ctx, ast.Load) and (known := self._only(node)) is not None:
            return known
        return f"{self.text(node.value, ATOM)}->{name_of(node.attr)}", ATOM

    def _only(self, node: ast.Attribute) -> tuple[str, int] | None:
        """The number that a field always is, where its range has but one."""
        owner = self.facts.owner(self.made, node.value)
        field = self.program.records.get(owner, {}).get(node.attr)
        wide = self.program.role.wide  # it may have been set to another
        if field is None or field.length or field.low != field.high or wide:
            return None
        return str(field.low), ATOM if field.low >= 0 else UNARY

    def _Subscript(self, node: ast.Subscript) -> tuple[str, int]:
        owner = node.value
        if isinstance(owner, ast.Attribute) and self._is_out(owner.value):
            out = self.text(owner.value, ATOM)
            if owner.attr == "limit":
                return f"{self.prefix.upper()}_OUTBOX", ATOM
            if owner.attr in OUT:
                return f"{out}->{owner.attr}", ATOM
            index = self.text(node.slice)
            if owner.attr == "frame":
                return f"{self.helper('frame')}({out}, {index})", ATOM
            return f"&{out}->action[{index}]", UNARY
        return f"{self.text(owner, ATOM)}[{self.text(node.slice)}]", ATOM

    def _is_out(self, node: ast.expr) -> bool:
        return isinstance(node, ast.Name) and self.made.types[node.id].what == "out"

    def _BinOp(self, node: ast.BinOp) -> tuple[str, int]:
        self.check_order(node, node.left, node.right)
        if isinstance(node.op, ast.FloorDiv | ast.Mod):
            facts = [self.facts.of(self.made, part).natural for part in (node.left, node.right)]
            if not all(facts):
                floor = "floor_div" if isinstance(node.op, ast.FloorDiv) else "floor_mod"
                text = f"{self.helper(floor)}({self.text(node.left)}, {self.text(node.right)})"
                return text, ATOM
            if not _is_power(node.right):
                # Unsigned: small processors divide by a function, and need only one.
                op = BINARY[type(node.op)]
                left, right = self.text(node.left, UNARY), self.text(node.right, UNARY)
                if not self.is_constant(node.right):
                    right = f"(uint32_t){right}"
                return f"(int32_t)((uint32_t){left} {op} {right})", UNARY
        op = BINARY[type(node.op)]
        if op in "+-":
            return f"{self.text(node.left, PLUS)} {op} {self.text(node.right, TIMES)}", PLUS
        if op in "*":
            return f"{self.text(node.left, TIMES)} {op} {self.text(node.right, UNARY)}", TIMES
        if op in "/%":
            return f"{self.text(node.left, UNARY)} {op} {self.text(node.right, UNARY)}", TIMES
        left = self.text(node.left, UNARY)
        if op in "&|^" and isinstance(node.left, ast.BinOp) and type(node.left.op) is type(node.op):
            left = self.text(node.left, BITS)
        return f"{left} {op} {self.text(node.right, UNARY)}", BITS

    def is_constant(self, node: ast.expr) -> bool:
        """True for a number, or a constant with a name, whatever its sign."""
        if isinstance(node, ast.UnaryOp):
            return self.is_constant(node.operand)
        return isinstance(node, ast.Constant) or (
            isinstance(node, ast.Name) and node.id not in self.made.types
        )

    def _UnaryOp(self, node: ast.UnaryOp, _as_test: bool) -> tuple[str, int]:
        signs = {ast.Not: "!", ast.USub: "-", ast.UAdd: "+", ast.Invert: "~"}
        inner = self.text(node.operand, ATOM, isinstance(node.op, ast.Not))
        return signs[type(node.op)] + inner, UNARY

    def _BoolOp(self, node: ast.BoolOp, as_test: bool) -> tuple[str, int]:
        *front, last = node.values
        is_and = isinstance(node.op, ast.And)
        flags = [self.facts.of(self.made, value).flag for value in node.values]
        if as_test or all(flags):
            inner, word, level = (ORDER, " && ", AND) if is_and else (ORDER, " || ", OR)
            return word.join(self.text(value, inner, True) for value in node.values), level
        tests = " && " if is_and else " || "
        test = tests.join(self.text(value, ORDER, True) for value in front)
        test = f"({test})" if len(front) > 1 else test
        if is_and:
            return f"{test} ? {self.text(last, OR)} : 0", CHOICE
        if not all(flags[:-1]):
            raise self.made.refuse(node, "`or` of what is not 0 or 1 is not in the dialect")
        return f"{test} ? 1 : {self.text(last, OR)}", CHOICE

    def _IfExp(self, node: ast.IfExp, as_test: bool) -> tuple[str, int]:
        test, body = self.text(node.test, ORDER, True), self.text(node.body, OR, as_test)
        return f"{test} ? {body} : {self.text(node.orelse, OR, as_test)}", CHOICE

    def _Compare(self, node: ast.Compare) -> tuple[str, int]:
        parts = [node.left, *node.comparators]
        self.check_order(node, *parts)
        if len(parts) > 2 and any(self.is_impure(part) for part in parts):
            raise self.made.refuse(node, "a chain of comparisons with a call that changes things")
        texts = [
            f"{self.text(left, PLUS)} {COMPARE[type(op)]} {self.text(right, PLUS)}"
            for left, op, right in zip(parts, node.ops, parts[1:], strict=False)
        ]
        return " && ".join(texts), ORDER if len(texts) == 1 else AND

    def _Call(self, node: ast.Call) -> tuple[str, int]:
        assert isinstance(node.func, ast.Name)
        self.check_order(node, *node.args)
        texts = [self.text(argument) for argument in node.args]
        if node in self.made.calls:
            return f"{self.prefix}_{self.made.calls[node].name}({', '.join(texts)})", ATOM
        assert node.func.id in BUILTINS
        name, text = self.helper(node.func.id), texts[0]
        if node.func.id == "abs":
            return f"{name}({text})", ATOM
        for more in texts[1:]:
            text = f"{name}({text}, {more})"
        return text, ATOM

    def is_impure(self, node: ast.AST) -> bool:
        """True if an expression changes something."""
        calls = self.made.calls
        return any(
            isinstance(inner, ast.Call) and inner in calls and bool(calls[inner].changed)
            for inner in every_node(node)
        )

    def check_order(self, node: ast.AST, *parts: ast.expr) -> None:
        """Python goes from left to right; C goes as it likes.

        Raises:
            Refused: one part changes what another one may read.
        """
        writes = [self._writes(part) for part in parts]
        if not any(writes):
            return
        reads = [self._reads(part) for part in parts]
        for i in range(len(parts)):
            for k in range(i):
                if writes[i] & (reads[k] | writes[k]) or writes[k] & reads[i]:
                    what = "one part changes what another reads: give it a line of its own"
                    raise self.made.refuse(node, what)

    def _calls(self, node: ast.AST) -> dict[ast.Call, Made]:
        calls = self.made.calls
        return {n: calls[n] for n in every_node(node) if isinstance(n, ast.Call) and n in calls}

    def _reads(self, node: ast.AST) -> set[str]:
        """Names of fields that an expression looks at."""
        parts = (inner for inner in every_node(node) if isinstance(inner, ast.Attribute | ast.Name))
        own = set[str]().union(*(array_of(self.made, part) for part in parts))
        return own.union(*(made.reads for made in self._calls(node).values()))

    def _writes(self, node: ast.AST) -> set[str]:
        """Names of fields that an expression changes, by itself or where it passes an array."""
        found: set[str] = set()
        for call, made in self._calls(node).items():
            found |= made.writes
            for name, argument in zip(made.arguments, call.args, strict=True):
                found |= array_of(self.made, argument) if name in made.changed else set()
        return found

    def place(self, node: ast.expr) -> Field | None:
        """The field that an assignment goes to; None for a variable."""
        inner = node.value if isinstance(node, ast.Subscript) else node
        if isinstance(inner, ast.Name):
            return self.made.types[inner.id].field if inner is not node else None
        assert isinstance(inner, ast.Attribute)
        if self._is_out(inner.value):
            return Field(inner.attr, "uint8_t", 0, 0, 255, "", "")
        owner = self.facts.owner(self.made, inner.value)
        return self.program.records[owner][inner.attr]


def local(name: str) -> str:
    """A variable's name in C."""
    return "turn_" if name == UNKNOWN else name_of(name)


def _is_power(node: ast.expr) -> bool:
    """True for a number that a shift or a mask divides by."""
    return (
        isinstance(node, ast.Constant)
        and isinstance(node.value, int)
        and node.value.bit_count() == 1
    )
