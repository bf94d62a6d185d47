"""Loops that are stopped as they go round: at a bound that no handler of a protocol needs.

That a loop does not end is seen in its source only now and then (loops.py). So the loops of a
folder's protocol count their rounds, in every run of it in Python and in compiled ones.
"""

import ast
import inspect

from innervate.dialect.loops import calls
from innervate.dialect.trees import every_node

MOST_ROUNDS = 1_000_000  # of a loop, each time that it is begun
AT_ONCE_MOST = 1_000  # times that a node may set timers for now, or the past, at one reading
AGAIN = "sets a timer that is due at once, again and again: time stands still"
_ERROR = ".EndlessLoop"  # names that no source can have
_COUNT = ".rounds"


class EndlessLoop(ArithmeticError):
    """A loop of a protocol goes on for longer than any handler may take."""


def bound(module):
    """Have the loops of a module's functions stop: EndlessLoop at the line of the loop.

    The functions stay the same objects, with the lines and names of their source.
    """
    if _ERROR in vars(module):
        return
    tree = ast.parse(inspect.getsource(module))
    made = [one.name for one in tree.body if isinstance(one, ast.FunctionDef) and _count(one)]
    if not made:
        return
    code = compile(ast.fix_missing_locations(tree), module.__file__, "exec")
    vars(module)[_ERROR] = EndlessLoop
    for one in code.co_consts:
        if inspect.iscode(one) and one.co_name in made:
            vars(module)[one.co_name].__code__ = one


def _count(function):
    """Have the loops of a function counted; how many there are that need it."""
    counter = _Counter(function.name)
    counter.visit(function)
    return counter.count


class _Counter(ast.NodeTransformer):
    """Writes into a function's loops that they count their rounds."""

    def __init__(self, name):
        self.name, self.count = name, 0

    def visit_While(self, node):
        self.generic_visit(node)
        self.count += 1
        name = f"{_COUNT}{self.count}"
        begun = ast.Assign([ast.Name(name, ast.Store())], ast.Constant(0))
        more = ast.AugAssign(ast.Name(name, ast.Store()), ast.Add(), ast.Constant(1))
        node.body[:0] = [more, self.stop(ast.Name(name, ast.Load()))]
        return [_at(node, begun), node]

    def visit_For(self, node):
        self.generic_visit(node)
        given = ast.Tuple(node.iter.args, ast.Load())
        names = [one for one in every_node(given) if isinstance(one, ast.Name)]
        if calls(given) or all(one.id.isupper() for one in names):
            return node
        self.count += 1
        rounds = ast.Call(ast.Name("len", ast.Load()), [node.iter], [])
        return [_at(node, self.stop(rounds)), node]

    def stop(self, rounds):
        """Raise if there are too many rounds."""
        says = f"a loop of more than {MOST_ROUNDS:,} rounds in {self.name}; see that it ends"
        error = ast.Call(ast.Name(_ERROR, ast.Load()), [ast.Constant(says)], [])
        test = ast.Compare(rounds, [ast.Gt()], [ast.Constant(MOST_ROUNDS)])
        return ast.If(test, [ast.Raise(error)], [])


def _at(node, made):
    """A statement that was made, at the line of a loop."""
    return ast.copy_location(made, node)
