"""What can be wrong with what is to become C; each message is one line."""

import ast


class FirmwareError(Exception):
    """It cannot be made as it is; says what to change."""


class Refused(FirmwareError):
    """A function is outside the dialect: names file and line."""

    def __init__(self, path: str, node: ast.AST, what: str) -> None:
        super().__init__(f"{path}:{getattr(node, 'lineno', 1)}: {what}")
