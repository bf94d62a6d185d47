"""A protocol's functions as one source: what boards, C and proofs are made from.

The functions stay as they are written, with the lines of their files. Where two files have a
function of the same name, the later one's is called after its file.
"""

import ast
import importlib
import inspect
from functools import lru_cache
from types import ModuleType

from innervate.dialect.checker import with_numbers
from innervate.dialect.trees import every_node

# (old, new): a text that stands once in the sources, and what is read in its place.
Change = tuple[str, str]


class Function:
    """A function of a protocol.

    Attributes:
        name: in the joined source; no other function has it.
        node: as it is written, with its docstring, its file's line numbers and its own name.
        module: the name of the module it stands in.
        path: the file of that module.
        constants: the whole numbers that it may use, by their names there: ONE, kinds.DATA.
        calls: the joined names of the functions that it may call, by their names there.
    """

    __slots__ = ("calls", "constants", "module", "name", "node", "path")

    def __init__(
        self, name: str, node: ast.FunctionDef, module: ModuleType, numbers: dict[str, int]
    ) -> None:
        self.name = name
        self.node = node
        self.module = module.__name__
        self.path = module.__file__ or ""
        used = {part.id for part in every_node(node) if isinstance(part, ast.Name)}
        self.constants = {
            name: value for name, value in numbers.items() if "." not in name or name in used
        }
        self.calls: dict[str, str] = {}


def functions(
    *entries: str, change: Change | None = None, shared: bool = False
) -> dict[str, Function]:
    """Every function that the entries' functions can reach, by joined name, callees first.

    Args:
        entries: modules with the five functions, like "innervate.networks.skin.protocol.cell". Of
            one, what its handlers call is taken; of several, all their functions are.
        change: a mistake to plant, within one function, for what must be found out.
        shared: of a source that was read before, the same nodes again, for who changes none.

    Raises:
        ValueError: the text to change does not stand exactly once in these functions.
    """
    modules: list[ModuleType] = []
    for entry in entries:
        modules += [module for module in reached(entry) if module not in modules]
    names = _names_of(modules)
    wanted = _called(modules, entries)
    found: dict[str, Function] = {}
    changed = 0
    for module in modules:
        text, numbers = inspect.getsource(module), numbers_of(module)
        if change is not None:
            changed += text.count(change[0])
            text = text.replace(*change)
        for node in (_parsed(text) if shared else with_numbers(ast.parse(text))).body:
            if isinstance(node, ast.FunctionDef) and (module.__name__, node.name) in wanted:
                made = Function(names[module.__name__, node.name], node, module, numbers)
                made.calls = _calls(module, names)
                found[made.name] = made
    if change is not None and changed != 1:
        raise ValueError(f"{change[0]!r} stands {changed} times in {', '.join(entries)}")
    return found


@lru_cache(100)
def _parsed(text: str) -> ast.Module:
    return with_numbers(ast.parse(text))


def numbers_of(module: ModuleType) -> dict[str, int]:
    """Whole numbers in capitals of a module, and of modules that it names: ONE, kinds.DATA."""
    found = {}
    for known, thing in vars(module).items():
        inside = vars(thing).items() if isinstance(thing, ModuleType) else ()
        for name, value in [(known, thing), *((f"{known}.{one}", it) for one, it in inside)]:
            if isinstance(value, int) and name.rpartition(".")[2].isupper():
                found[name] = int(value)
    return found


def reached(entry: str) -> list[ModuleType]:
    """The modules that a protocol's functions lie in, callees first; `entry` is its own."""
    found: list[ModuleType] = []

    def visit(module: ModuleType) -> None:
        for thing in vars(module).values():
            if inspect.isfunction(thing) and thing.__module__ != module.__name__:
                lower = importlib.import_module(thing.__module__)
                if lower not in found:
                    visit(lower)
        if module not in found:
            found.append(module)

    visit(importlib.import_module(entry))
    return found


def _own(module: ModuleType) -> list[str]:
    return [
        name
        for name, thing in vars(module).items()
        if inspect.isfunction(thing) and thing.__module__ == module.__name__
    ]


def _names_of(modules: list[ModuleType]) -> dict[tuple[str, str], str]:
    """What (module, function) is called in the joined source; entries keep their names."""
    taken: set[str] = set()
    names = {}
    for module in reversed(modules):
        short = module.__name__.rpartition(".")[2]
        for name in _own(module):
            names[module.__name__, name] = new = f"{short}_{name}" if name in taken else name
            taken.add(new)
    return names


def _calls(module: ModuleType, names: dict[tuple[str, str], str]) -> dict[str, str]:
    """Joined names of the functions that a module knows, by their names in it."""
    return {
        known: names[thing.__module__, thing.__name__]
        for known, thing in vars(module).items()
        if inspect.isfunction(thing) and (thing.__module__, thing.__name__) in names
    }


def _called(modules: list[ModuleType], entries: tuple[str, ...]) -> set[tuple[str, str]]:
    """(module, function) of the handlers and of all that they call, directly or not."""
    by_name = {module.__name__: module for module in modules}
    waiting = [
        (entry, name)
        for entry in entries
        for name in _own(by_name[entry])
        if name.startswith("on_") or len(entries) > 1
    ]
    found = set(waiting)
    while waiting:
        home, name = waiting.pop()
        module = by_name[home]
        for used in getattr(module, name).__code__.co_names:
            thing = vars(module).get(used)
            if inspect.isfunction(thing):
                key = (thing.__module__, thing.__name__)
                if key not in found:
                    found.add(key)
                    waiting.append(key)
    return found
