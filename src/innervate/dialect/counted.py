"""How many actions a call of a handler can put into its outbox, from its source alone."""

import ast

from innervate.dialect.trees import every_node

PUTS = {"put", "send", "set_timer", "deliver", "report"}
NEVER = -1  # there is no such way


class Unknown(Exception):
    """A loop whose number of rounds is not seen; `line` where it stands."""

    def __init__(self, line):
        super().__init__(line)
        self.line = line


def actions(name, functions, constants):
    """Most actions of a call of a function, every branch taken that has most.

    Args:
        name: of the function.
        functions: nodes of all functions that it may call, by name.
        constants: whole numbers by name.

    Raises:
        Unknown: it puts actions in a loop whose rounds are not seen.
    """
    return max(_of_block(functions[name].body, functions, constants))


def _of_block(statements, functions, constants):
    """Most actions on ways that go on behind the block, and on those that return in it."""
    on, ended = 0, NEVER
    for statement in statements:
        more, returned = _of(statement, functions, constants)
        ended = max(ended, _sum(on, returned))
        on = _sum(on, more)
    return on, ended


def _sum(first, second):
    return NEVER if NEVER in (first, second) else first + second


def _of(node, functions, constants):
    if isinstance(node, ast.Return):
        return NEVER, _of_expression(node, functions, constants)
    if isinstance(node, ast.If):
        first = _of_expression(node.test, functions, constants)
        sides = [_of_block(side, functions, constants) for side in (node.body, node.orelse)]
        return tuple(_sum(first, max(ways)) for ways in zip(*sides, strict=True))
    if isinstance(node, (ast.For, ast.While)):
        on, ended = _of_block(node.body, functions, constants)
        if max(on, ended) <= 0:
            return 0, ended
        rounds = _rounds(node, constants)
        if rounds is None:
            raise Unknown(node.lineno)
        each = max(on, 0)
        return rounds * each, _sum(max(rounds - 1, 0) * each, ended) if rounds else NEVER
    return _of_expression(node, functions, constants), NEVER


def _of_expression(node, functions, constants):
    total = 0
    for part in every_node(node):
        if isinstance(part, ast.Call):
            name = part.func.attr if isinstance(part.func, ast.Attribute) else part.func.id
            if name in PUTS:
                total += 1
            elif name in functions:
                total += actions(name, functions, constants)
    return total


def _rounds(node, constants):
    if isinstance(node, ast.While):
        return None
    values = []
    for argument in node.iter.args:
        if isinstance(argument, ast.Constant):
            values.append(argument.value)
        elif isinstance(argument, ast.Name) and argument.id in constants:
            values.append(constants[argument.id])
        else:
            return None
    return len(range(*values))
