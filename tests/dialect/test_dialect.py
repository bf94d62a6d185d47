"""The protocol dialect (CONTRIBUTING.md): what compiles, explores and runs on boards alike."""

import ast
from functools import cache
from pathlib import Path

import pytest

import innervate
from innervate.dialect.checker import broken_rules, functions_of, imports_of, is_ours

HOME = Path(innervate.__file__).parent
FOLDERS = (HOME / "dialect", *sorted((HOME / "networks").glob("*/protocol")))
SOURCES = [path for folder in FOLDERS for path in sorted(folder.rglob("*.py"))]
ABOUT = {
    "copies.py",
    "source.py",
    "checker.py",
    "bounded.py",
    "held.py",
    "loops.py",
    "clocks.py",
    "folder.py",
    "sends.py",
    "counted.py",
    "trees.py",
}  # read files, so import what that takes
PYTHON = {"plain.py", "__init__.py", *ABOUT}  # about protocols, in full Python


def dialect_sources():
    """The files that compile: not the declarations, the plain classes or the package itself."""
    return [
        path for path in SOURCES if path.name not in PYTHON and not path.name.endswith("fields.py")
    ]


@cache
def known_functions():
    return {
        function.name
        for path in dialect_sources()
        for function in functions_of(ast.parse(path.read_text()))
    }


@pytest.mark.parametrize("path", dialect_sources(), ids=lambda path: path.name)
def test_protocol_source_keeps_to_the_dialect(path):
    assert broken_rules(path.read_text(), known_functions()) == []


@pytest.mark.parametrize("path", [p for p in SOURCES if p.name not in ABOUT], ids=str)
def test_protocol_imports_only_itself(path):
    assert [m for m, _ in imports_of(ast.parse(path.read_text())) if not is_ours(m)] == []


GOOD = '''"""Doc."""

from innervate.dialect import arith
from innervate.dialect.arith import later
from . import outbox

LIMIT = (1 << 30) - 1
NONE = -1


def helper(cell, n):
    """Doc."""
    while n > 0 and not cell.done:
        n -= 1
        if n == 3:
            break
    return abs(n)


def on_frame(cell, params, now, port, frame, out):
    """Doc."""
    for p in range(4):
        cell.dist[p] = min(helper(cell, p), LIMIT) if later(now, p) else NONE
    arith.after(now, 1)
    return True
'''


def test_what_the_dialect_has():
    assert broken_rules(GOOD, {"later", "after"}) == []
    assert broken_rules(inside("return later(cell, 1073741823)"), {"later"}) == []
    assert broken_rules(inside("cell.a = cell.b[n] = n + 1")) == []


def inside(body):
    return f'"""Doc."""\n\n\ndef f(cell, n):\n    """Doc."""\n    {body}\n'


BAD = {
    "class": '"""Doc."""\n\n\nclass A:\n    pass\n',
    "no module docstring": "A = 1\n",
    "no docstring": '"""Doc."""\n\n\ndef f(a):\n    return a\n',
    "foreign import": '"""Doc."""\nimport numpy\n',
    "foreign from": '"""Doc."""\nfrom math import floor\n',
    "look-alike import": '"""Doc."""\nimport innervate.dialects\n',
    "import star": '"""Doc."""\nfrom innervate.dialect.arith import *\n',
    "import inside": inside("import innervate.dialect.arith"),
    "statement at the top": '"""Doc."""\nfor i in range(3):\n    pass\n',
    "variable at the top": '"""Doc."""\nlimit = 3\n',
    "call at the top": '"""Doc."""\nLIMIT = max(1, 2)\n',
    "default": '"""Doc."""\n\n\ndef f(a=1):\n    """Doc."""\n',
    "keyword only": '"""Doc."""\n\n\ndef f(*, a):\n    """Doc."""\n',
    "positional only": '"""Doc."""\n\n\ndef f(a, /):\n    """Doc."""\n',
    "star arguments": '"""Doc."""\n\n\ndef f(*a):\n    """Doc."""\n',
    "double star": '"""Doc."""\n\n\ndef f(**a):\n    """Doc."""\n',
    "annotation": '"""Doc."""\n\n\ndef f(a: int):\n    """Doc."""\n',
    "decorator": '"""Doc."""\n\n\n@abs\ndef f(a):\n    """Doc."""\n',
    "async": '"""Doc."""\n\n\nasync def f(a):\n    """Doc."""\n',
    "function inside": inside('def g():\n        """Doc."""'),
    "lambda": inside("return max(lambda: 1, 2)"),
    "keyword argument": inside("return f(cell, n=1)"),
    "star in a call": inside("return f(*cell)"),
    "unknown call": inside("return len(cell)"),
    "method call": inside("cell.reset()"),
    "call of a result": inside("f(cell, n)(1)"),
    "try": inside("try:\n        pass\n    finally:\n        pass"),
    "raise": inside("raise n"),
    "assert": inside("assert n"),
    "with": inside("with n:\n        pass"),
    "delete": inside("del n"),
    "global": inside("global n"),
    "yield": inside("yield n"),
    "match": inside("match n:\n        case 1:\n            pass"),
    "string": inside('return "a"'),
    "late docstring": inside('n = 1\n    "a"'),
    "f-string": inside('return f"{n}"'),
    "bytes": inside('return b"a"'),
    "float": inside("return 1.5"),
    "complex": inside("return 1j"),
    "none": inside("return None"),
    "ellipsis": inside("..."),
    "large number": inside("return 1073741824"),
    "true division": inside("return n / 2"),
    "power": inside("return n ** 2"),
    "list": inside("return [n]"),
    "dict": inside("return {n: n}"),
    "set": inside("return {n}"),
    "tuple": inside("a, b = n, n"),
    "tuple returned": inside("return n, n"),
    "list comprehension": inside("return [i for i in range(n)]"),
    "generator": inside("return max(i for i in range(n))"),
    "slice": inside("return cell[1:2]"),
    "in": inside("return n in cell"),
    "is": inside("return n is cell"),
    "walrus": inside("return (m := n)"),
    "annotated variable": inside("m: int = n"),
    "for over an array": inside("for i in cell:\n        pass"),
    "for with else": inside("for i in range(n):\n        pass\n    else:\n        pass"),
    "for with two": inside("for i, j in range(n):\n        pass"),
    "while with else": inside("while n:\n        pass\n    else:\n        pass"),
    "variables together": inside("m = cell.a = 1"),
    "a call for several": inside("cell.a = cell.b = min(n, 1)"),
    "several of what one of them was": inside("cell.a = cell.b[0] = cell.a + 1"),
    "a place of several, by another name": inside("n[0] = n[1] = n[0] + 1"),
    "a field's place, by another name": inside("n[0] = n[1] = cell.b[0] + 1"),
    "a call between several": inside("cell.b[min(n, 1)] = cell.a = cell.c"),
    "range kept": inside("m = range(n)"),
    "while that never ends": inside("while n > 0:\n        cell.x = 1"),
    "while true": inside("while True:\n        n -= 1"),
    "recursion": inside("return f(cell, n)"),
}


@pytest.mark.parametrize("source", BAD.values(), ids=BAD.keys())
def test_what_the_dialect_has_not(source):
    assert broken_rules(source)


# What a caller's record or outbox is changed by, besides assignments to fields.
EFFECTS = {"draw", "report", "set_timer", "send", "deliver"}
PREDICATES = ("is_", "has_", "was_", "in_", "can_", "trusts_")


def changes(function):
    """1 if a function itself changes a record, draws, or puts something into the outbox."""
    for node in ast.walk(function):
        targets = node.targets if isinstance(node, ast.Assign) else []
        targets = [node.target] if isinstance(node, ast.AugAssign) else targets
        if any(not isinstance(target, ast.Name) for target in targets):
            return True
        if isinstance(node, ast.Call) and called(node) in EFFECTS:
            return True
    return False


def called(call):
    return call.func.id if isinstance(call.func, ast.Name) else call.func.attr


def changing(functions):
    """Names of those that change something, themselves or by what they call."""
    found = {name for name, function in functions.items() if changes(function)}
    calls = {
        name: {called(node) for node in ast.walk(function) if isinstance(node, ast.Call)}
        for name, function in functions.items()
    }
    while more := {name for name in calls if name not in found and calls[name] & found}:
        found |= more
    return found


@pytest.mark.parametrize("folder", FOLDERS, ids=lambda folder: folder.parent.name)
def test_what_is_named_as_a_question_changes_nothing(folder):
    sources = [path for path in dialect_sources() if path.is_relative_to(folder)]
    functions = {
        function.name: function
        for path in sources
        for function in functions_of(ast.parse(path.read_text()))
    }
    assert [name for name in sorted(changing(functions)) if name.startswith(PREDICATES)] == []


def test_a_change_is_found_behind_a_call():
    source = "def set_it(r):\n    r.x = 1\n"
    source += "def is_it(r):\n    return set_it(r)\n"
    source += "def is_so(r):\n    x = r.x"
    functions = {function.name: function for function in functions_of(ast.parse(source))}
    assert changing(functions) == {"set_it", "is_it"}
