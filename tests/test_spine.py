"""No file of the spine names a network: not in an import, a comparison or a table by kinds."""

import ast
from pathlib import Path

import innervate
from innervate.network import networks

HOME_OF_NETWORKS = "innervate.networks"
# For type checkers; imported while the program runs by who asks for a name of theirs.
TYPED = {"innervate.networks.typed", "innervate.networks.models"}
HOME = Path(innervate.__file__).parent
# The same letters for something else: an element of a robot's description, a shape in a scene.
OTHER_MEANINGS = {"topology/cover.py", "topology/collada.py"}


def spine():
    return [path for path in sorted(HOME.rglob("*.py"))
            if "networks" not in path.relative_to(HOME).parts]  # fmt: skip


def docstrings(tree):
    holders = (ast.Module, ast.ClassDef, ast.FunctionDef, ast.AsyncFunctionDef)
    for node in ast.walk(tree):
        if isinstance(node, holders) and node.body and isinstance(node.body[0], ast.Expr):
            yield node.body[0].value


def named(path):
    """(line, what) of every string that is the name of a network, and of imports of one."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    prose = set(docstrings(tree))
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and node not in prose and node.value in networks():
            yield node.lineno, node.value
        source = node.module or "" if isinstance(node, ast.ImportFrom) else ""
        if source.startswith(HOME_OF_NETWORKS) and source not in TYPED:
            yield node.lineno, source


def test_the_spine_names_no_network():
    found = [
        f"{path.relative_to(HOME)}:{line} {what}"
        for path in spine()
        if str(path.relative_to(HOME)) not in OTHER_MEANINGS
        for line, what in named(path)
    ]
    assert found == []


def test_a_name_is_noticed(tmp_path):
    bad = tmp_path / "bad.py"
    bad.write_text(
        '"""skin"""\nfrom innervate.networks.skin import frames\n'
        'if frames.kind == "skin":\n    WORDS = {"mesh": 1}\n'
    )
    assert sorted(named(bad)) == [(2, "innervate.networks.skin"), (3, "skin"), (4, "mesh")]
