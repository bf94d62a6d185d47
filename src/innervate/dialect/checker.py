"""The dialect's checker: what a source breaks of it, at which line, and what to write instead.

CONTRIBUTING.md has the dialect. A source is read, not run.
"""

import ast

from innervate.dialect import loops
from innervate.dialect.trees import every_node

PACKAGE = "innervate.dialect"
BUILTINS = {"abs", "max", "min", "range"}
DEBUGGING = {"breakpoint", "print"}  # may be called in plain runs

# Every kind of syntax that the dialect has; whatever is not here is refused by its name.
PLAIN = (
    *(ast.Module, ast.Expr, ast.alias, ast.arguments, ast.arg, ast.Load, ast.Store),
    *(ast.Assign, ast.AugAssign, ast.If, ast.While, ast.Return, ast.Pass, ast.Break, ast.Continue),
    *(ast.Name, ast.Attribute, ast.Subscript, ast.IfExp, ast.keyword),  # check_Call: keywords
    *(ast.Compare, ast.Eq, ast.NotEq, ast.Lt, ast.LtE, ast.Gt, ast.GtE),
    *(ast.BoolOp, ast.And, ast.Or, ast.UnaryOp, ast.Not, ast.USub, ast.UAdd, ast.Invert),
    *(ast.BinOp, ast.Add, ast.Sub, ast.Mult, ast.FloorDiv, ast.Mod),
    *(ast.LShift, ast.RShift, ast.BitAnd, ast.BitOr, ast.BitXor),
)

# What to write instead of syntax that the dialect has not.
INSTEAD = {
    "Div": "divide whole numbers with //",
    "Pow": "multiply, or shift with <<",
    "List": "declare a field with a length in fields.py",
    "Tuple": "assign one name at a time, return one number",
    "Dict": "declare fields in fields.py",
    "Set": "declare a field with a length, 0 or 1 for each",
    "ListComp": "write a for over range(...)",
    "SetComp": "write a for over range(...)",
    "DictComp": "write a for over range(...)",
    "GeneratorExp": "write a for over range(...)",
    "In": "compare with each, joined by or",
    "NotIn": "compare with each, joined by and",
    "Is": "compare with ==",
    "IsNot": "compare with !=",
    "ClassDef": "declare fields in fields.py, write functions",
    "AsyncFunctionDef": "write a plain function; drivers wait",
    "Lambda": "write a function of its own",
    "Try": "check before, with an if",
    "Raise": "report(out, code, a, b), and return",
    "Assert": "put it into invariants.py",
    "Slice": "write a for over range(...)",
    "Global": "keep it in a field of the state",
    "Nonlocal": "keep it in a field of the state",
    "JoinedStr": "report(out, code, a, b) with numbers",
    "NamedExpr": "assign in a line of its own",
    "AnnAssign": "leave the annotation out",
    "Match": "write if and elif",
    "Yield": "return one number",
    "Starred": "write the arguments one by one",
    "Delete": "leave it out",
}


class Broken(str):
    """A rule that is broken, as "line: what"; `line` and `what` apart, too.

    `in_plain`: for plain runs it is none.
    """

    def __new__(cls, line, what, in_plain=False):
        """A rule broken at a line."""
        made = super().__new__(cls, f"{line}: {what}")
        made.line, made.what, made.in_plain = line, what, in_plain
        return made


def broken_rules(source, known=frozenset(), home=""):
    """What a source breaks of the dialect, in order of its lines.

    Args:
        source: the text of a file.
        known: names of functions of other files that it may import and call.
        home: the package whose files it may import, besides the dialect's.

    Raises:
        SyntaxError: it is no Python.
    """
    return sorted(Checker(source, set(known), home).check(), key=lambda one: one.line)


def functions_of(tree):
    """The functions at the top of a file."""
    return [node for node in tree.body if isinstance(node, ast.FunctionDef)]


def imports_of(tree, package=PACKAGE):
    """(module, name bound here) of every import; relative ones are of `package`."""
    for node in every_node(tree):
        if isinstance(node, ast.Import):
            for alias in node.names:
                yield alias.name, alias.asname or alias.name
        elif isinstance(node, ast.ImportFrom):
            module = f"{package}.{node.module or ''}".rstrip(".") if node.level else node.module
            for alias in node.names:
                yield module, alias.asname or alias.name


def is_ours(module, home=""):
    """True if a protocol may import a module: the dialect's, or of the protocol's own package."""
    parts = module.split(".")
    of_network = parts[:2] == ["innervate", "networks"] and "protocol" in parts
    own = home and f"{module}.".startswith(f"{home}.")
    return bool(f"{module}.".startswith(f"{PACKAGE}.") or of_network or own)


def _is_docstring(node, parents):
    """A bare string is the first statement of a module or function."""
    owner = parents.get(parents.get(node))
    return (
        isinstance(node.value, str)
        and isinstance(owner, (ast.Module, ast.FunctionDef))
        and owner.body[0] is parents[node]
    )


class _Numbers(ast.NodeTransformer):
    def __init__(self, modules):
        self.modules = modules

    def visit_Attribute(self, node):
        owner = getattr(node.value, "id", "")
        if owner in self.modules and node.attr.isupper():
            return ast.copy_location(ast.Name(f"{owner}.{node.attr}", node.ctx), node)
        return self.generic_visit(node)

    def visit_Assign(self, node):
        self.generic_visit(node)
        return [
            ast.copy_location(ast.Assign([target], node.value), node) for target in node.targets
        ]


def with_numbers(tree):
    """A file's tree, plainer: a number of another module is one name, "kinds.DATA"; where several
    fields are assigned to at once, an assignment each.
    """
    return _Numbers({name for _, name in imports_of(tree)}).visit(tree)


def _attributes(node):
    """The names behind a dot in an expression."""
    return {part.attr for part in every_node(node) if isinstance(part, ast.Attribute)}


def _stored(node):
    """The names that something gives a value to."""
    return {part.id for part in every_node(node)
            if isinstance(part, ast.Name) and isinstance(part.ctx, ast.Store)}  # fmt: skip


class Checker:
    """Collects what a source breaks (see broken_rules)."""

    def __init__(self, source, known, home=""):
        self.tree = ast.parse(source)
        self.home = home
        self.broken = []
        self.known = known | {function.name for function in functions_of(self.tree)}
        imports = imports_of(self.tree, home or PACKAGE)
        self.imported = {name for module, name in imports if is_ours(module, home)}
        self.own = _stored(self.tree)
        self.own |= {node.arg for node in every_node(self.tree) if isinstance(node, ast.arg)}
        self.stored = {}  # variables by function
        self.at_top = set().union(
            *(_stored(node) for node in self.tree.body if isinstance(node, ast.Assign))
        )
        self.at_top |= {name for _, name in imports_of(self.tree, home or PACKAGE)} | self.known
        self.parents = {
            child: node for node in every_node(self.tree) for child in ast.iter_child_nodes(node)
        }

    def complain(self, node, what):
        """Note what is broken, at the line of a node."""
        self.broken.append(Broken(getattr(node, "lineno", self._line_of(node)), what))

    def _line_of(self, node):
        """The line of what has none itself, like an operator."""
        while node in self.parents and not hasattr(node, "lineno"):
            node = self.parents[node]
        return getattr(node, "lineno", 1)

    def check(self):
        """Everything that the source breaks."""
        if ast.get_docstring(self.tree) is None:
            self.complain(self.tree, "no module docstring; begin the file with one line of it")
        for node in self.walk(self.tree):
            special = getattr(self, "check_" + type(node).__name__, None)
            if special:
                special(node)
            elif not isinstance(node, PLAIN):
                name = type(node).__name__
                more = f"; {INSTEAD[name]}" if name in INSTEAD else ""
                self.complain(node, f"{name} is not in the dialect{more}")
        for node in self.tree.body:
            self.check_top(node)
        self.check_recursion()
        return self.broken

    def walk(self, node):
        """All nodes but those inside calls that a person debugs with, which are noted."""
        waiting = [node]
        for one in waiting:
            if isinstance(one, ast.Call) and getattr(one.func, "id", "") in DEBUGGING - self.known:
                what = f"calls {one.func.id}; it may stay for plain runs: run --plain"
                self.broken.append(Broken(one.lineno, what, in_plain=True))
            else:
                waiting += ast.iter_child_nodes(one)
                yield one

    def check_top(self, node):
        """A statement at the top of the file."""
        is_doc = isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)
        allowed = (ast.Import, ast.ImportFrom, ast.FunctionDef, ast.Assign)
        if not is_doc and not isinstance(node, allowed):
            self.complain(node, "only imports, constants and functions at the top; "
                                "put the rest into a function")  # fmt: skip
        if isinstance(node, ast.Assign):
            names = [t.id for t in node.targets if isinstance(t, ast.Name)]
            if len(names) != len(node.targets) or names != [name.upper() for name in names]:
                self.complain(node, "a module constant is a name in capitals; what changes is a "
                                    "field of the state")  # fmt: skip
            if any(isinstance(part, ast.Call) for part in every_node(node.value)):
                self.complain(node, "a module constant calls nothing; write the number")

    def check_Assign(self, node):
        """Of several fields that are given a value at once none is read in it, also by another
        name, and nothing is called: C and proofs read it once for each.
        """
        if len(node.targets) > 1 and self.parents[node] is not self.tree:
            is_call = any(isinstance(part, ast.Call) for part in every_node(node))
            is_place = any(isinstance(part, ast.Subscript) for part in every_node(node.value))
            given = set().union(*map(_attributes, node.targets))
            is_variable = any(isinstance(target, ast.Name) for target in node.targets)
            if is_call or is_place or is_variable or given & _attributes(node.value):
                self.complain(node, "only fields are given a value together, nothing is called, "
                                    "no x[i] is read and none of them; write one each")  # fmt: skip

    def check_Import(self, node):
        """What is imported as modules."""
        for alias in node.names:
            if not is_ours(alias.name, self.home):
                self.complain(node, f"imports {alias.name}; only {PACKAGE} and files of the "
                                    "protocol can be imported")  # fmt: skip
        self.check_place_of_import(node)

    def check_ImportFrom(self, node):
        """What is imported from modules."""
        if not node.level and not is_ours(node.module or "", self.home):
            self.complain(node, f"imports {node.module}; only {PACKAGE} and files of the "
                                "protocol can be imported")  # fmt: skip
        if any(alias.name == "*" for alias in node.names):
            self.complain(node, "imports *; name what is imported")
        self.check_place_of_import(node)

    def check_place_of_import(self, node):
        """Imports stand at the file's top."""
        if self.parents[node] is not self.tree:
            self.complain(node, "imports inside something; import at the top")

    def check_FunctionDef(self, node):
        """Functions have plain arguments and a docstring."""
        if self.parents[node] is not self.tree:
            self.complain(node, "a function inside something; move it to the top")
        if node.decorator_list:
            self.complain(node, "a decorator; leave it out")
        if node.returns or any(arg.annotation for arg in node.args.args):
            self.complain(node, "annotations; leave them out, boards' Python has none")
        args = node.args
        if args.defaults or args.kwonlyargs or args.vararg or args.kwarg or args.posonlyargs:
            self.complain(node, "arguments other than plain positional ones; name each, no default")
        if ast.get_docstring(node) is None:
            self.complain(node, f"{node.name} has no docstring; say in a line what it does")

    def check_Constant(self, node):
        """Numbers are whole, and below 2^30."""
        if isinstance(node.value, str):
            if not _is_docstring(node, self.parents):
                self.complain(node, "a string; use numbers, named by module constants")
        elif isinstance(node.value, (float, complex, bytes)) or node.value is ...:
            name = type(node.value).__name__
            self.complain(node, f"a {name}; count in whole numbers of a smaller unit")
        elif node.value is None:
            self.complain(node, "None; use a number that is never a value, like -1")
        elif node.value >= 1 << 30:
            self.complain(node, "a number of 2^30 or more; all values stay below")

    def check_Subscript(self, node):
        """Places of an array are counted from its beginning."""
        index = node.slice
        if isinstance(index, ast.UnaryOp) and isinstance(index.op, ast.USub):
            if isinstance(index.operand, ast.Constant):
                self.complain(node, f"[-{index.operand.value}]: an index is 0 or more; count from "
                                    "the beginning")  # fmt: skip

    def check_Name(self, node):
        """Names are variables of their function, or constants, functions and modules."""
        is_called = getattr(self.parents[node], "func", None) is node
        known = node.id in self.at_top or node.id in self.variables(node)
        if isinstance(node.ctx, ast.Load) and not known and not is_called:
            self.complain(node, f"{node.id} is given no value here, and is no constant")

    def variables(self, node):
        """What the function that a node stands in gives a value to, and its arguments."""
        while node in self.parents and not isinstance(node, ast.FunctionDef):
            node = self.parents[node]
        if node not in self.stored:
            given = {one.arg for one in node.args.args} if isinstance(node, ast.FunctionDef) else ()
            self.stored[node] = _stored(node).union(given)
        return self.stored[node]

    def check_Attribute(self, node):
        """Of a module constants are looked at, and nothing is set."""
        owner = getattr(node.value, "id", "")
        called = getattr(self.parents[node], "func", None) is node
        is_field = owner in self.own and not node.attr.isupper()
        if owner not in self.imported or called or is_field:
            return
        if owner in self.own:
            self.complain(node, f"{owner} is a module here, and a variable; rename the variable")
        elif not node.attr.isupper() or isinstance(node.ctx, ast.Store):
            self.complain(node, f"{owner}.{node.attr} of a module that is imported; only its "
                                "constants can be looked at")  # fmt: skip

    def check_Call(self, node):
        """Calls are of functions that the protocol has."""
        if node.keywords:
            self.complain(node, "a keyword argument; give it by its place")
        called = node.func
        if isinstance(called, ast.Attribute) and isinstance(called.value, ast.Name):
            # module.function: only of a module of this package
            if called.value.id not in self.imported or called.attr not in self.known:
                self.complain(node, f"calls {called.value.id}.{called.attr}; only functions of "
                                    "the protocol and of the dialect can be called")  # fmt: skip
        elif not isinstance(called, ast.Name):
            self.complain(node, "calls something that is no name; call functions by their names")
        elif called.id not in self.known | BUILTINS:
            self.complain(node, f"calls {called.id}; only functions of the protocol, of the "
                                f"dialect, and {', '.join(sorted(BUILTINS))}")  # fmt: skip
        if isinstance(called, ast.Name) and called.id == "range":
            owner = self.parents[node]
            if not (isinstance(owner, ast.For) and owner.iter is node):
                self.complain(node, "range outside a for; write for i in range(...)")

    def check_For(self, node):
        """A for loop is over a range."""
        loop = node.iter
        is_range = isinstance(loop, ast.Call) and isinstance(loop.func, ast.Name)
        if not (is_range and loop.func.id == "range"):
            self.complain(node, "a for over something that is no range; write for i in range(...)")
        if not isinstance(node.target, ast.Name):
            self.complain(node, "a for with more than one variable; write one loop for each")
        if node.orelse:
            self.complain(node, "a for with an else; write it after the loop")

    def check_While(self, node):
        """A while goes on only as long as what it looks at changes."""
        if node.orelse:
            self.complain(node, "a while with an else; write it after the loop")
        if wrong := loops.endless(node):
            self.complain(node, f"a loop without bound: {wrong}")

    def check_recursion(self):
        """No function calls itself, directly or by others."""
        functions = {function.name: function for function in functions_of(self.tree)}
        calls = {
            name: {part.func.id for part in every_node(function)
                   if isinstance(part, ast.Call) and isinstance(part.func, ast.Name)}
            & set(functions)
            for name, function in functions.items()
        }  # fmt: skip
        for name, function in functions.items():
            reached, waiting = set(), list(calls[name])
            while waiting:
                one = waiting.pop()
                if one not in reached:
                    reached.add(one)
                    waiting += calls[one]
            if name in reached:
                self.complain(function, f"a loop without bound: {name} calls itself; "
                                        "write for i in range(...)")  # fmt: skip
