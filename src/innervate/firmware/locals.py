"""Where a variable is declared in C: at its first value where that is possible, else ahead."""

import ast

from innervate.dialect.trees import every_node


def names_in(node: ast.AST) -> set[str]:
    """The variables that occur in there."""
    return {inner.id for inner in every_node(node) if isinstance(inner, ast.Name)}


def mentions(node: ast.AST, name: str) -> bool:
    """True if a variable occurs in there."""
    return name in names_in(node)


def is_changed(body: list[ast.stmt], name: str) -> bool:
    """True if these statements give a variable another value."""
    return any(
        isinstance(inner, ast.Name) and inner.id == name and isinstance(inner.ctx, ast.Store)
        for statement in body
        for inner in every_node(statement)
    )


def _blocks(node: ast.stmt) -> tuple[list[ast.AST], list[list[ast.stmt]]]:
    """What of a statement is looked at before its blocks, and these."""
    if isinstance(node, ast.If):
        return [node.test], [node.body, node.orelse]
    if isinstance(node, ast.While):
        return [node.test], [node.body]
    if isinstance(node, ast.For):
        return [node.iter], [node.body]
    return [node], []


def _is_first_value(statement: ast.stmt, name: str) -> bool:
    if not isinstance(statement, ast.Assign):
        return False
    target = statement.targets[0]
    is_target = isinstance(target, ast.Name) and target.id == name
    return is_target and not mentions(statement.value, name)


def _is_inside(statement: ast.stmt, name: str) -> bool:
    """True if a variable can be declared within a statement: nothing of it is needed around."""
    heads, blocks = _blocks(statement)
    if any(mentions(head, name) for head in heads):
        return False
    if isinstance(statement, ast.For):
        assert isinstance(statement.target, ast.Name)
        if statement.target.id == name:
            return True
    return bool(blocks) and all(_is_own(block, name) for block in blocks)


def _is_own(body: list[ast.stmt], name: str) -> bool:
    """True if a block gives a variable a value before it looks at it, whatever was before."""
    found = [statement for statement in body if mentions(statement, name)]
    if not found or all(_is_inside(statement, name) for statement in found):
        return True
    return _is_first_value(found[0], name)


def declared_at(
    body: list[ast.stmt], names: list[str]
) -> tuple[list[str], dict[str, ast.stmt], dict[ast.stmt, list[str]]]:
    """Where variables are declared that may be declared in a block.

    Returns:
        Those that stand ahead of it; those that are declared by an assignment of it; those that
        are declared within a statement of it.
    """
    ahead, at, inner = [], {}, {}  # type: ignore[var-annotated]
    held = [names_in(statement) for statement in body]
    for name in names:
        found = [statement for statement, own in zip(body, held, strict=True) if name in own]
        if not found:
            continue
        if all(_is_inside(statement, name) for statement in found):
            for statement in found:
                inner.setdefault(statement, []).append(name)
        elif _is_first_value(found[0], name):
            at[name] = found[0]
        else:
            ahead.append(name)
    return ahead, at, inner
