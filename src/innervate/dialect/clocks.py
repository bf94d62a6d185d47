"""Readings of a clock that are compared as what they are not, and waits that are taken for some.

A node's clock begins anywhere and goes round at 2^30 us, after 18 minutes, so that `<` says the
wrong thing of two readings; and `later` is of sequence numbers, which go round at 2^16. A timer is
set to a reading.
"""

import ast

from innervate.dialect.arith import MASK16, MASK30
from innervate.dialect.folder import Finding
from innervate.dialect.trees import every_node

ORDERS = (ast.Lt, ast.LtE, ast.Gt, ast.GtE)


WAITS = {"draw", "sooner", "time_left"}  # functions of the dialect that give no reading
OF_WAITS = {"abs", "max", "min"}  # these give what they are given


def of_clocks(path, tables, params=frozenset()):
    """Comparisons of `now` by its size, and of what is no sequence number by `later`; and timers
    that are set to how long they are to run.

    Args:
        path: a file of the protocol, or of its invariants.
        tables: the declared fields of states, frames and parameters.
        params: names of parameters that no other field has.
    """
    most = {}  # of two fields of one name the lesser: nothing is refused that may be right
    for name, _length, _low, high, *_ in tables:
        most[name] = min(most.get(name, high), high)
    found = []
    for function in every_node(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(function, ast.FunctionDef):
            has_now = "now" in {argument.arg for argument in function.args.args}
            for part in every_node(function):
                wrong = (has_now and _by_size(part)) or _by_sequence(part, most, has_now)
                wrong = wrong or _by_wait(part, function, params)
                if wrong:
                    found.append(Finding(path, part.lineno, wrong))
    return found


def _by_size(part):
    """What is wrong with a comparison, of `now` or of a difference that it is in."""
    if not (isinstance(part, ast.Compare) and isinstance(part.ops[0], ORDERS)):
        return ""
    for side in (part.left, *part.comparators):
        if _is_now(side):
            return (
                f"{ast.unparse(part)}: now goes round at 2^30 and begins anywhere; write "
                "after(a, b) of innervate.dialect.arith"
            )
        is_difference = isinstance(side, ast.BinOp) and isinstance(side.op, ast.Sub)
        if is_difference and (_is_now(side.left) or _is_now(side.right)):
            said = ast.unparse(side)
            return f"{said} is below 0 when the clock goes round; write ({said}) & MASK30"
    return ""


def _by_sequence(part, most, has_now):
    """What is wrong with a call of `later`."""
    if not (isinstance(part, ast.Call) and ast.unparse(part.func).rpartition(".")[2] == "later"):
        return ""
    for given in part.args:
        field = given.value if isinstance(given, ast.Subscript) else given
        name, high = "now", MASK30
        if isinstance(field, ast.Attribute):
            name, high = field.attr, most.get(field.attr, 0)
        elif not (has_now and _is_now(field)):
            continue
        if high > MASK16:
            return (
                f"{ast.unparse(part)}: later is for sequence numbers of 16 bits, and {name} is up "
                f"to {high}; readings of a clock are compared by after(a, b)"
            )
    return ""


def _by_wait(part, function, params):
    """What is wrong with a call of `set_timer`."""
    is_set = isinstance(part, ast.Call) and ast.unparse(part.func).endswith("set_timer")
    if not (is_set and len(part.args) == 3 and _is_wait(part.args[2], function, params)):
        return ""
    said = ast.unparse(part.args[2])
    return (
        f"set_timer takes when, a reading of the clock, and {said} is how long; "
        f"write (now + {said}) & MASK30"
    )


def _targets(one):
    return one.targets if isinstance(one, ast.Assign) else [one.target]


def _is_wait(part, function, params, above=frozenset()):
    """True if an expression is made of numbers, parameters and draws alone."""
    if isinstance(part, ast.Name):
        if part.id.isupper() or part.id in above:
            return True
        given = [one.value for one in every_node(function)
                 if isinstance(one, (ast.Assign, ast.AugAssign))
                 and part.id in {getattr(to, "id", "") for to in _targets(one)}]  # fmt: skip
        inside = above | {part.id}
        return bool(given) and all(_is_wait(one, function, params, inside) for one in given)
    if isinstance(part, ast.Attribute):
        return part.attr in params or part.attr.isupper()
    if isinstance(part, ast.Call):
        name = getattr(part.func, "id", "")
        parts = part.args if name in OF_WAITS else ()
        return name in WAITS or bool(parts and all(
            _is_wait(one, function, params, above) for one in parts))  # fmt: skip
    inside = [one for one in ast.iter_child_nodes(part) if isinstance(one, ast.expr)]
    return all(_is_wait(one, function, params, above) for one in inside)


def _is_now(part):
    return isinstance(part, ast.Name) and part.id == "now"
