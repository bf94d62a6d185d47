"""Values that follow from others: arithmetic over scenario keys, `2 + 100 / protocol.beacon_hz`."""

import ast
import math
import operator
import re
from collections.abc import Callable
from contextlib import suppress
from typing import Any

from innervate.sweeping.errors import SweepError

LENGTH_MAX = 500
_NAME = re.compile(r"(?<![\w.])[A-Za-z_][A-Za-z0-9_]*(?:\.[A-Za-z0-9_]+)*")
_BINARY: dict[type[ast.operator], Callable[[Any, Any], Any]] = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.FloorDiv: operator.floordiv,
    ast.Mod: operator.mod,
}
_FUNCTIONS: dict[str, Callable[..., Any]] = {
    one.__name__: one for one in (min, max, abs, round, math.floor, math.ceil, math.sqrt, math.log2)
}


class Formula:
    """An arithmetic expression: + - * / // %, brackets, numbers, keys, and a few functions.

    Args:
        text: like "max(4, protocol.k // 2)".
        where: begins the error messages.

    Raises:
        SweepError: it is not such an expression.
    """

    def __init__(self, text: str, where: str) -> None:
        self.text = text
        self.where = where
        self.keys: list[str] = []
        if len(text) > LENGTH_MAX:
            raise SweepError(f"{where}: longer than {LENGTH_MAX} characters")
        try:
            self._tree = ast.parse(_NAME.sub(self._placed, text).strip(), mode="eval").body
        except (SyntaxError, ValueError, RecursionError, MemoryError):
            raise SweepError(f'{where}: "{text}" is no arithmetic over keys') from None

    def _placed(self, match: re.Match[str]) -> str:
        """A key becomes a name that Python can read; functions stay."""
        name = match[0]
        if name in _FUNCTIONS and match.string[match.end() :].lstrip().startswith("("):
            return name
        if name not in self.keys:
            self.keys.append(name)
        return f"_{self.keys.index(name)}"

    def value(self, look_up: Callable[[str], Any]) -> float | int:
        """What it comes to, with the values of keys that `look_up` gives; it has to be a number."""
        with suppress(OverflowError, ValueError, TypeError, RecursionError):
            try:
                result = self._of(self._tree, look_up)
            except ZeroDivisionError:
                raise SweepError(f"{self.where}: {self.text} divides by zero") from None
            if isinstance(result, int | float) and math.isfinite(result):
                return result
        raise SweepError(f"{self.where}: {self.text} comes to no number")

    def _of(self, node: ast.expr, look_up: Callable[[str], Any]) -> Any:
        if isinstance(node, ast.Constant) and type(node.value) in (int, float):
            return node.value
        if isinstance(node, ast.Name):
            return self._number(self.keys[int(node.id[1:])], look_up)
        if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
            return -self._of(node.operand, look_up)
        if isinstance(node, ast.BinOp) and type(node.op) in _BINARY:
            return _BINARY[type(node.op)](
                self._of(node.left, look_up), self._of(node.right, look_up)
            )
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and not node.keywords:
            function = _FUNCTIONS.get(node.func.id)  # else a key stands where a function should
            if function is not None:
                return function(*(self._of(argument, look_up) for argument in node.args))
        allowed = f"+ - * / // %, numbers, keys, {', '.join(_FUNCTIONS)}"
        raise SweepError(f"{self.where}: {self.text} has more in it than {allowed}")

    def _number(self, key: str, look_up: Callable[[str], Any]) -> float | int:
        try:
            value = look_up(key)
        except LookupError:
            raise SweepError(
                f"{self.where}: there is no {key} in the scenario nor among what is varied"
            ) from None
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise SweepError(f"{self.where}: {key} is no number")
        return value
