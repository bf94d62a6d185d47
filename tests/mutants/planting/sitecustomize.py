"""Puts a fault into this process as it imports the module; files stay as they are.

Python imports a module of this name at its start: so with this folder on PYTHONPATH processes that
tests start have the fault, too. INNERVATE_FAULT says which; without it nothing happens.
"""

import ast
import json
import os
from importlib.machinery import SourceFileLoader

FAULT = "INNERVATE_FAULT"
planted = []  # where


def plant(path, start, end, new, plain):
    """From now on the file at `path` is imported with `new` from byte `start` to `end`.

    With `plain` every function of the toolkit that can be asked to run plain is, always.
    """
    planted.append(path)
    read = SourceFileLoader.get_code

    def get_code(loader, name):
        is_faulty = loader.path == path
        if not is_faulty and not (plain and name.startswith("innervate")):
            return read(loader, name)
        source = loader.get_data(loader.path)
        if is_faulty:
            source = source[:start] + new.encode() + source[end:]
        elif b"plain: bool" not in source:
            return read(loader, name)
        tree = always_plain(ast.parse(source)) if plain else source
        return compile(tree, loader.path, "exec", dont_inherit=True)

    SourceFileLoader.get_code = get_code


def always_plain(tree):
    """Functions with an argument `plain` set it at their beginning."""
    for node in ast.walk(tree):
        if isinstance(node, ast.FunctionDef):
            arguments = [*node.args.args, *node.args.kwonlyargs]
            if any(one.arg == "plain" for one in arguments):
                at = 1 if ast.get_docstring(node) is not None and len(node.body) > 1 else 0
                node.body[at:at] = ast.parse("plain = True").body
    return ast.fix_missing_locations(tree)


if os.environ.get(FAULT):
    plant(**json.loads(os.environ[FAULT]))
