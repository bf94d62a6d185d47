"""How many actions a call of a handler can put into its outbox, from its source alone."""

import ast

PUTS = {"put", "send", "set_timer", "deliver", "report"}


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
    return _of_block(functions[name].body, functions, constants)


def _of_block(statements, functions, constants):
    total = 0
    for statement in statements:
        total += _of(statement, functions, constants)
    return total


def _of(node, functions, constants):
    if isinstance(node, ast.If):
        most = max(_of_block(side, functions, constants) for side in (node.body, node.orelse))
        return _of_expression(node.test, functions, constants) + most
    if isinstance(node, (ast.For, ast.While)):
        each = _of_block(node.body, functions, constants)
        if not each:
            return 0
        rounds = _rounds(node, constants)
        if rounds is None:
            raise Unknown(node.lineno)
        return rounds * each
    return _of_expression(node, functions, constants)


def _of_expression(node, functions, constants):
    total = 0
    for part in ast.walk(node):
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
