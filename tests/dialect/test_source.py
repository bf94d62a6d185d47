"""A protocol's functions as one source, for boards, C and proofs."""

import ast
from pathlib import Path
from types import ModuleType

import pytest

from innervate.dialect import source
from innervate.dialect.checker import with_numbers
from innervate.dialect.trees import every_node

CELL = "innervate.networks.skin.protocol.cell"
MESH = "innervate.networks.mesh.protocol.node"


@pytest.mark.parametrize("file", [source.__file__, __file__])
def test_a_tree_is_walked_as_python_does(file):
    tree = ast.parse(Path(file).read_text(encoding="utf-8"))
    assert every_node(tree) == list(ast.walk(tree))


def test_functions_come_callees_first_with_all_that_they_call():
    found = source.functions(CELL)
    places = {name: i for i, name in enumerate(found)}
    for name, function in found.items():
        for node in ast.walk(function.node):
            if isinstance(node, ast.Name) and node.id in function.calls:
                assert function.calls[node.id] in found, (name, node.id)
    assert places["later"] < places["is_allowed"] < places["select"] < places["on_timer"]


def test_a_function_knows_its_file_line_and_constants():
    select = source.functions(CELL)["select"]
    assert select.module == "innervate.networks.skin.protocol.route"
    line = Path(select.path).read_text().splitlines()[select.node.lineno - 1]
    assert line == "def select(cell, params, may_balance, out):"
    assert select.constants["INFINITY"] == 255
    assert select.constants["NONE"] == -1


def test_names_that_two_files_share_are_told_apart():
    found = source.functions(MESH)
    assert len({(f.module, f.node.name) for f in found.values()}) == len(found)


def test_a_mistake_is_planted_in_one_place_only():
    old = "return sq == cell.fd_sq and dist < cell.fd_dist"
    made = source.functions(CELL, change=(old, "return True"))
    assert ast.unparse(made["nearer_than_fd"].node).endswith("return True")
    for text in ("no such text", "cell.hold = 0"):
        with pytest.raises(ValueError, match="times in innervate"):
            source.functions(CELL, change=(text, text))


def test_constants_are_in_capitals():
    module = ModuleType("some")
    vars(module).update(LIMIT=3, IS_ON=True, limit=4, Name="a", __file__="some.py")
    found = source.Function(
        "f", ast.parse("def f():\n    pass").body[0], module, source.numbers_of(module)
    )
    assert found.constants == {"LIMIT": 3, "IS_ON": 1}
    assert (found.module, found.path) == ("some", "some.py")


def test_numbers_of_modules_that_are_named_have_their_modules_names():
    module, kinds = ModuleType("some"), ModuleType("kinds")
    vars(kinds).update(DATA=5, far=6, ACK=7, Name=8)
    vars(module).update(kinds=kinds, ONE=1, __file__="some.py")
    assert source.numbers_of(module) == {"kinds.DATA": 5, "kinds.ACK": 7, "ONE": 1}
    text = "import kinds\ndef f(x):\n    x.at[kinds.DATA].DATA = kinds.far + ONE"
    (_, node) = with_numbers(ast.parse(text)).body
    assert ast.unparse(node) == text.partition("\n")[2]
    names = {part.id for part in ast.walk(node) if isinstance(part, ast.Name)}
    assert names == {"x", "kinds.DATA", "kinds", "ONE"}
    assert source.Function("f", node, module, source.numbers_of(module)).constants == {
        "kinds.DATA": 5,
        "ONE": 1,
    }
