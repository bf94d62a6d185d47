"""Which test files may notice a fault, those first that lie nearest.

A test lies where its source lies, or leads there by what it imports (modules that are named in
strings count: parts of networks are imported by name). What is recorded of all that comes out
(`tests/recorded`) comes after the tests of the module itself, before those further away.
"""

from __future__ import annotations

import ast
import re
from collections import defaultdict
from pathlib import Path

from tests.mutants.draw import SOURCES, Fault

FILES_MAX = 30
STEPS_MAX = 3
NAMED = re.compile(r"innervate(?:\.\w+)+")
ALSO = {"web": {"browser"}, "view": {"web", "browser"}, "live": {"livesim"}}  # by room
RECORDED = {
    "cli": "commands", "live": "nodes", "papers": "pictures", "sim": "recorded",
    "plot": "pictures", "running": "commands", "view": "watched", "web": "watched",
}  # fmt: skip


class Choice:
    """Knows what imports what.

    Args:
        root: of the project.
    """

    def __init__(self, root: Path) -> None:
        self.modules = {
            ".".join(path.relative_to(base).with_suffix("").parts).removesuffix(".__init__"): path
            for base, folder in ((root / "src", "innervate"), (root, "tests"))
            for path in sorted((base / folder).rglob("*.py"))
        }
        self.root = root
        self.tests = [path for path in self.modules.values() if path.name.startswith("test_")]
        self._users: dict[Path, set[Path]] = defaultdict(set)
        for path in self.modules.values():
            for used in self._imported(path) - {path}:
                self._users[used].add(path)

    def _imported(self, path: Path) -> set[Path]:
        names: set[str] = set()
        for node in ast.walk(ast.parse(path.read_bytes())):
            if isinstance(node, ast.Import):
                names |= {one.name for one in node.names}
            elif isinstance(node, ast.ImportFrom) and node.module:
                inner = {f"{node.module}.{one.name}" for one in node.names}
                names |= inner if inner & self.modules.keys() else {node.module}
            elif isinstance(node, ast.Constant) and isinstance(node.value, str):
                names |= set(NAMED.findall(node.value))
        return {self.modules[name] for name in names if name in self.modules}

    def steps_to(self, source: Path) -> dict[Path, int]:
        """Files that lead to a source by their imports, with how many steps away they are."""
        found, edge = {source: 0}, {source}
        for steps in range(1, STEPS_MAX + 1):
            edge = {user for one in edge for user in self._users[one]} - found.keys()
            found |= dict.fromkeys(edge, steps)
        return found

    def tests_for(self, path: str, words: set[str]) -> list[str]:
        """Test files for a source, nearest first; of equally near ones those that say the words."""
        steps = self.steps_to(self.root / path)
        inside = Path(path).relative_to(SOURCES)
        ranked = []
        for test in self.tests:
            name = test.relative_to(self.root)
            rank = self._rank(name, inside, steps.get(test, STEPS_MAX + 1))
            if rank is not None:
                ranked.append((rank, -shared(name.as_posix(), words), name.as_posix()))
        return [name for *_, name in sorted(ranked)[:FILES_MAX]]

    @staticmethod
    def _rank(test: Path, inside: Path, steps: int) -> int | None:
        """0 = written for the source; None = has nothing to do with it."""
        folder = test.parts[1:-1]
        is_beside = folder == inside.parts[:-1]
        is_named = test.stem.removeprefix("test_") == inside.stem
        if is_named and (steps <= STEPS_MAX or set(folder) & set(inside.parts)):
            return 0
        if steps == 1 or (is_beside and steps == 2):
            return 1
        if folder == ("recorded",):
            name = test.stem.removeprefix("test_")
            is_first = name in {RECORDED.get(part) for part in inside.parts[:-1]}
            return 2 if is_first else 4 if name == "kept" else 6
        if is_beside or steps <= STEPS_MAX:
            return 3 if is_beside else 3 + steps
        rooms = set(inside.parts[:-1]) - {"networks"}
        wanted = rooms.union(*(ALSO.get(room, ()) for room in rooms))
        return 7 if wanted & set(folder) else None


def words_of(root: Path, fault: Fault) -> set[str]:
    """What a test of a faulty line would be called by: its place, its function, its names."""
    before = (root / fault.path).read_bytes()[: fault.start].decode()
    inner = re.findall(r"\b(?:def|class) (\w+)", before)[-1:]
    place = Path(fault.path).relative_to(SOURCES).with_suffix("").as_posix()
    return {word for word in split(" ".join([place, *inner, fault.text])) if len(word) > 2}


def shared(test: str, words: set[str]) -> int:
    """How many of the words the name of a test has."""
    return len(words & split(test))


def split(text: str) -> set[str]:
    """The words in paths and names."""
    return set(re.split(r"[^a-z0-9]+", text.lower()))
