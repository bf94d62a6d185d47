"""The protocol dialect (CONTRIBUTING.md): what compiles, explores and runs on boards alike."""

import ast
from pathlib import Path

import pytest

import innervate

HOME = Path(innervate.__file__).parent
FOLDERS = (HOME / "dialect", *sorted((HOME / "networks").glob("*/protocol")))
PACKAGE = "innervate.dialect"
SOURCES = [path for folder in FOLDERS for path in sorted(folder.rglob("*.py"))]
PYTHON = {"plain.py", "copies.py", "source.py", "__init__.py"}  # about protocols, in full Python
ABOUT = {"copies.py", "source.py"}  # read files, so import what that takes
BUILTINS = {"abs", "max", "min", "range"}

# Every kind of syntax that the dialect has; whatever is not here is refused by its name.
PLAIN = (
    *(ast.Module, ast.Expr, ast.alias, ast.arguments, ast.arg, ast.Load, ast.Store),
    *(ast.Assign, ast.AugAssign, ast.If, ast.While, ast.Return, ast.Pass, ast.Break, ast.Continue),
    *(ast.Name, ast.Attribute, ast.Subscript, ast.IfExp),
    *(ast.Compare, ast.Eq, ast.NotEq, ast.Lt, ast.LtE, ast.Gt, ast.GtE),
    *(ast.BoolOp, ast.And, ast.Or, ast.UnaryOp, ast.Not, ast.USub, ast.UAdd, ast.Invert),
    *(ast.BinOp, ast.Add, ast.Sub, ast.Mult, ast.FloorDiv, ast.Mod),
    *(ast.LShift, ast.RShift, ast.BitAnd, ast.BitOr, ast.BitXor),
)


def dialect_sources():
    """The files that compile: not the declarations, the plain classes or the package itself."""
    return [
        path for path in SOURCES if path.name not in PYTHON and not path.name.endswith("fields.py")
    ]


def functions_of(tree):
    return [node for node in tree.body if isinstance(node, ast.FunctionDef)]


def imports_of(tree):
    """(module, name bound here) of every import."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            for alias in node.names:
                yield alias.name, alias.asname or alias.name
        elif isinstance(node, ast.ImportFrom):
            module = f"{PACKAGE}.{node.module or ''}".rstrip(".") if node.level else node.module
            for alias in node.names:
                yield module, alias.asname or alias.name


def is_ours(module):
    parts = module.split(".")
    of_network = parts[:2] == ["innervate", "networks"] and "protocol" in parts
    return f"{module}.".startswith(f"{PACKAGE}.") or of_network


def is_docstring(node, parents):
    """A bare string is the first statement of a module or function."""
    owner = parents.get(parents.get(node))
    return (
        isinstance(node.value, str)
        and isinstance(owner, ast.Module | ast.FunctionDef)
        and owner.body[0] is parents[node]
    )


class Checker:
    """Collects what a source breaks, as "line: what"."""

    def __init__(self, source, known):
        self.tree = ast.parse(source)
        self.broken = []
        self.known = known | {function.name for function in functions_of(self.tree)}
        self.imported = {name for module, name in imports_of(self.tree) if is_ours(module)}
        self.parents = {
            child: node for node in ast.walk(self.tree) for child in ast.iter_child_nodes(node)
        }

    def complain(self, node, what):
        self.broken.append(f"{getattr(node, 'lineno', 1)}: {what}")

    def check(self):
        if ast.get_docstring(self.tree) is None:
            self.complain(self.tree, "no module docstring")
        for node in ast.walk(self.tree):
            special = getattr(self, "check_" + type(node).__name__, None)
            if special:
                special(node)
            elif not isinstance(node, PLAIN):
                self.complain(node, f"{type(node).__name__} is not in the dialect")
        for node in self.tree.body:
            self.check_top(node)
        return self.broken

    def check_top(self, node):
        is_doc = isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)
        allowed = (ast.Import, ast.ImportFrom, ast.FunctionDef, ast.Assign)
        if not is_doc and not isinstance(node, allowed):
            self.complain(node, "only imports, constants and functions at the top")
        if isinstance(node, ast.Assign):
            names = [t.id for t in node.targets if isinstance(t, ast.Name)]
            if len(names) != len(node.targets) or names != [name.upper() for name in names]:
                self.complain(node, "a module constant is a name in capitals")
            if any(isinstance(part, ast.Call) for part in ast.walk(node.value)):
                self.complain(node, "a module constant calls nothing")

    def check_Import(self, node):
        for alias in node.names:
            if not is_ours(alias.name):
                self.complain(node, f"imports {alias.name}")
        self.check_place_of_import(node)

    def check_ImportFrom(self, node):
        if not node.level and not is_ours(node.module or ""):
            self.complain(node, f"imports {node.module}")
        if any(alias.name == "*" for alias in node.names):
            self.complain(node, "imports *")
        self.check_place_of_import(node)

    def check_place_of_import(self, node):
        if self.parents[node] is not self.tree:
            self.complain(node, "imports inside something")

    def check_FunctionDef(self, node):
        if self.parents[node] is not self.tree:
            self.complain(node, "a function inside something")
        if node.decorator_list:
            self.complain(node, "a decorator")
        if node.returns or any(arg.annotation for arg in node.args.args):
            self.complain(node, "annotations")
        args = node.args
        if args.defaults or args.kwonlyargs or args.vararg or args.kwarg or args.posonlyargs:
            self.complain(node, "arguments other than plain positional ones")
        if ast.get_docstring(node) is None:
            self.complain(node, "no docstring")

    def check_Constant(self, node):
        if isinstance(node.value, str):
            if not is_docstring(node, self.parents):
                self.complain(node, "a string")
        elif isinstance(node.value, float | complex | bytes) or node.value is ...:
            self.complain(node, f"a {type(node.value).__name__}")
        elif node.value is None:
            self.complain(node, "None")
        elif node.value >= 1 << 30:
            self.complain(node, "a number of 2^30 or more")

    def check_Call(self, node):
        if node.keywords:
            self.complain(node, "a keyword argument")
        called = node.func
        if isinstance(called, ast.Attribute) and isinstance(called.value, ast.Name):
            # module.function: only of a module of this package
            if called.value.id not in self.imported or called.attr not in self.known:
                self.complain(node, f"calls {called.value.id}.{called.attr}")
        elif not isinstance(called, ast.Name):
            self.complain(node, "calls something that is no name")
        elif called.id not in self.known | BUILTINS:
            self.complain(node, f"calls {called.id}")
        if isinstance(called, ast.Name) and called.id == "range":
            owner = self.parents[node]
            if not (isinstance(owner, ast.For) and owner.iter is node):
                self.complain(node, "range outside a for")

    def check_For(self, node):
        loop = node.iter
        is_range = isinstance(loop, ast.Call) and isinstance(loop.func, ast.Name)
        if not (is_range and loop.func.id == "range"):
            self.complain(node, "a for over something that is no range")
        if not isinstance(node.target, ast.Name):
            self.complain(node, "a for with more than one variable")
        if node.orelse:
            self.complain(node, "a for with an else")

    def check_While(self, node):
        if node.orelse:
            self.complain(node, "a while with an else")


def broken_rules(source, known=frozenset()):
    """What `source` breaks of the dialect; `known` are functions of the room's other files."""
    return Checker(source, set(known)).check()


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
    assert broken_rules(inside("return f(cell, 1073741823)")) == []


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
    "range kept": inside("m = range(n)"),
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
