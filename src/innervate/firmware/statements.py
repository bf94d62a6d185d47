"""Statements of a protocol as C has them, with the comments that stand at them."""

import ast
import io
import re
import tokenize
from functools import cache
from pathlib import Path

from innervate.dialect.trees import every_node
from innervate.firmware.expressions import BINARY, PLUS, Expressions, local
from innervate.firmware.locals import declared_at, is_changed
from innervate.firmware.program import Type

COLUMNS = 100
STEP = "    "
WORDS = {ast.Pass: "", ast.Break: "break", ast.Continue: "continue"}


@cache
def comments_of(path: str) -> dict[int, tuple[str, bool]]:
    """Comments of a file by their lines, and whether a comment has its line to itself."""
    text = Path(path).read_text(encoding="utf-8")
    return {
        token.start[0]: (token.string.lstrip("# "), not token.line[: token.start[1]].strip())
        for token in tokenize.generate_tokens(io.StringIO(text).readline)
        if token.type == tokenize.COMMENT and not token.string.startswith("# fmt")
    }


class Statements:
    """Writes the body of one function."""

    def __init__(self, expressions: Expressions, types: dict[Type, str]) -> None:
        self.expressions = expressions
        self.made = expressions.made
        self.types = types
        self.comments = comments_of(self.made.function.path)
        self.lines: list[str] = []

    def body(self) -> list[str]:
        """The lines between the braces."""
        node = self.made.function.node
        rest = node.body[1:]
        names = [name for name in self.made.types if name not in self.made.arguments]
        self._block(rest, 1, names, node.body[0].end_lineno or 0)
        if self.made.returns.what == "int" and not ends(rest):
            self._put(1, "return 0;")
        return [*self._unused(), *self.lines]

    def _unused(self) -> list[str]:
        """Arguments that nothing is asked of: compilers want to know that it is meant."""
        text = re.sub(r"/\*.*?\*/", "", "\n".join(self.lines), flags=re.DOTALL)
        used = set(re.findall(r"(?<![\w.>])\w+", text))  # no fields
        names = [local(name) for name in self.made.arguments]
        return [f"{STEP}(void){name};" for name in names if name not in used]

    def _put(self, depth: int, text: str, note: str = "") -> None:
        self.lines += wrapped(STEP * depth + text + (f" /* {note} */" if note else ""))

    def _note(self, line: int) -> str:
        """The comment behind a line of Python."""
        text, alone = self.comments.get(line, ("", True))
        return "" if alone else text

    def _notes(self, after: int, before: int, depth: int) -> None:
        """Comments that have lines to themselves between two lines of Python."""
        found = [self.comments.get(line, ("", False)) for line in range(after + 1, before)]
        for line in comment(" ".join(text for text, alone in found if alone), STEP * depth):
            self.lines.append(line)

    def _block(self, body: list[ast.stmt], depth: int, names: list[str], line: int) -> None:
        """Statements; `names` are variables that may be declared in here."""
        first, at, inner = declared_at(body, names)
        for name in first:
            self._put(depth, f"{self._declared(name)};")
        for statement in body:
            self._notes(line, statement.lineno, depth)
            declared = [name for name in at if at[name] is statement]
            getattr(self, f"_{type(statement).__name__}")(
                statement, depth, declared or inner.get(statement, [])
            )
            line = statement.end_lineno or statement.lineno

    def _declared(self, name: str) -> str:
        return declaration(self.types[self.made.types[name]], local(name))

    def _Assign(self, node: ast.Assign, depth: int, declared: list[str]) -> None:
        target = node.targets[0]
        if isinstance(target, ast.Name):
            name = local(target.id)
            left = self._declared(target.id) if target.id in declared else name
            self._put(depth, f"{left} = {self.expressions.text(node.value)};",
                      self._note(node.end_lineno or 0))  # fmt: skip
            return
        if isinstance(target, ast.Subscript):
            self.expressions.check_order(node, target.slice, node.value)
        text = self.expressions.text(target)
        self._put(depth, f"{text} = {self._narrowed(target, node.value)};",
                  self._note(node.end_lineno or 0))  # fmt: skip

    def _AugAssign(self, node: ast.AugAssign, depth: int, _declared: list[str]) -> None:
        whole = ast.BinOp(node.target, node.op, node.value)
        ast.copy_location(whole, node)
        if isinstance(node.target, ast.Subscript) and self.expressions.is_impure(node.target.slice):
            raise self.made.refuse(node, "an index that changes things stands in C twice")
        target, note = self.expressions.text(node.target), self._note(node.end_lineno or 0)
        if isinstance(node.target, ast.Name) and type(node.op) in BINARY:
            self._put(depth, f"{target} = {self.expressions.text(whole)};", note)
        else:
            self._put(depth, f"{target} = {self._narrowed(node.target, whole)};", note)

    def _narrowed(self, target: ast.expr, value: ast.expr) -> str:
        """A value as a field takes it: C compilers want to know that it is meant."""
        field = self.expressions.place(target)
        text = self.expressions.text(value)
        if field is None or field.type == "int32_t" or self.expressions.is_constant(value):
            return text
        if isinstance(value, ast.Attribute | ast.Subscript):
            other = self.expressions.place(value)
            if other is not None and other.type == field.type:
                return text
        inner = self.expressions.text(value, 1)
        return f"({field.type}){inner}"

    def _Expr(self, node: ast.Expr, depth: int, _declared: list[str]) -> None:
        call = self.expressions.text(node.value)
        returned = self.made.calls[node.value].returns  # type: ignore[index]
        text = call if returned.what == "none" else f"(void){call}"
        self._put(depth, f"{text};", self._note(node.end_lineno or 0))

    def _Return(self, node: ast.Return, depth: int, _declared: list[str]) -> None:
        note = self._note(node.end_lineno or 0)
        if node.value is not None:
            self._put(depth, f"return {self.expressions.text(node.value)};", note)
        elif self.made.returns.what == "none":
            self._put(depth, "return;", note)
        else:
            self._put(depth, "return 0;", note)

    def _If(self, node: ast.If, depth: int, names: list[str], word: str = "if") -> None:
        self._put(depth, f"{word} ({self.expressions.text(node.test, as_test=True)}) {{",
                  self._note(node.body[0].lineno - 1 if node.body[0].lineno > node.lineno else 0)
                  or self._note(node.lineno))  # fmt: skip
        self._block(node.body, depth + 1, names, node.body[0].lineno - 1)
        rest = node.orelse
        if len(rest) == 1 and isinstance(rest[0], ast.If):
            first, _at, inner = declared_at(rest, names)
            if not first:
                self._notes(node.body[-1].end_lineno or 0, rest[0].lineno, depth + 1)
                self._If(rest[0], depth, inner.get(rest[0], []), "} else if")
                return
        if rest:
            self._put(depth, "} else {")
            self._block(rest, depth + 1, names, node.body[-1].end_lineno or 0)
        self._put(depth, "}")

    def _While(self, node: ast.While, depth: int, names: list[str]) -> None:
        self._put(depth, f"while ({self.expressions.text(node.test, as_test=True)}) {{",
                  self._note(node.lineno))  # fmt: skip
        self._block(node.body, depth + 1, names, node.body[0].lineno - 1)
        self._put(depth, "}")

    def _For(self, node: ast.For, depth: int, names: list[str]) -> None:
        assert isinstance(node.iter, ast.Call)
        assert isinstance(node.target, ast.Name)
        target, arguments = node.target.id, node.iter.args
        end = self._bound(node, arguments[-1], depth)
        start = self.expressions.text(arguments[0]) if len(arguments) == 2 else "0"
        counter, name = local(target), local(target)
        keeps = target not in names or is_changed(node.body, target)
        if keeps:  # what it was stays behind the loop, or the body sets it
            counter = f"next_{name}".replace("__", "_")
        head = f"for (int32_t {counter} = {start}; {counter} < {end}; {counter}++) {{"
        self._put(depth, head, self._note(node.lineno))
        if keeps:
            left = self._declared(target) if target in names else name
            self._put(depth + 1, f"{left} = {counter};")
        rest = [other for other in names if other != target]
        self._block(node.body, depth + 1, rest, node.body[0].lineno - 1)
        self._put(depth, "}")

    def _bound(self, node: ast.For, end: ast.expr, depth: int) -> str:
        """The end of a range; Python asks for it once."""
        text = self.expressions.text(end, PLUS)
        reads = [n for n in every_node(end) if isinstance(n, ast.Name) and n.id in self.made.types]
        steady = all(
            self.made.types[name.id].what == "params"
            or (self.made.types[name.id].what == "int" and not is_changed(node.body, name.id))
            for name in reads
        )
        if text.isdigit() or (steady and not any(isinstance(n, ast.Call) for n in every_node(end))):
            return text
        assert isinstance(node.target, ast.Name)
        name = f"{local(node.target.id)}_end_{node.lineno}".replace("__", "_")
        self._put(depth, f"const int32_t {name} = {self.expressions.text(end)};")
        return name

    def _Pass(self, node: ast.stmt, depth: int, _declared: list[str]) -> None:
        self._put(depth, f"{WORDS[type(node)]};", self._note(node.lineno))

    _Break = _Continue = _Pass


def ends(body: list[ast.stmt]) -> bool:
    """True if nothing comes behind these statements."""
    last = body[-1] if body else None
    if isinstance(last, ast.If):
        return ends(last.body) and ends(last.orelse)
    return isinstance(last, ast.Return)


def declaration(kind: str, name: str) -> str:
    """A variable with its type: the star stands at the name."""
    return f"{kind}{'' if kind.endswith('*') else ' '}{name}"


def comment(text: str, margin: str) -> list[str]:
    """A comment of its own, in as many lines as it needs."""
    if not text:
        return []
    lines, line = [], margin + "/*"
    for word in text.replace("*/", "* /").split():
        if len(line) + len(word) + 4 > COLUMNS:
            lines.append(line)
            line = margin + " *"
        line += " " + word
    return [*lines, line + " */"]


def wrapped(text: str) -> list[str]:
    """A line of C in lines that fit, broken behind an operator or a comma."""
    if text.endswith("*/") and len(text) > COLUMNS:
        text, _, note = text.rpartition(" /* ")
        margin = text[: len(text) - len(text.lstrip())]
        return [*comment(note.removesuffix(" */"), margin), *wrapped(text)]
    margin = text[: len(text) - len(text.lstrip())] + STEP * 2
    lines = []
    while len(text) > COLUMNS:
        near = [max(text.rfind(mark, COLUMNS // 2, COLUMNS - 1) + len(mark) - 1 for mark in marks)
                for marks in ((" && ", " || "), (", ", " + "))]  # fmt: skip
        at = near[0] if near[0] > COLUMNS // 2 else near[1]
        if at <= len(margin):
            break
        lines.append(text[:at].rstrip())
        text = margin + text[at:].lstrip()
    return [*lines, text]
