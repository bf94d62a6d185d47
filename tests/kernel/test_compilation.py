"""Compilation: what the cache of compiled code is known by, so that none of it is stale."""

import shutil

import pytest

from innervate.analysis import intervals
from innervate.dialect import arith
from innervate.kernel import compilation
from innervate.networks.mesh.protocol import node


@pytest.fixture
def copied(tmp_path):
    shutil.copytree(
        compilation.ROOT, tmp_path / "innervate", ignore=shutil.ignore_patterns("page", "*.pyc")
    )
    return tmp_path / "innervate"


@pytest.fixture
def foreign(monkeypatch):
    monkeypatch.setattr(compilation, "_foreign", set())
    return compilation._foreign


@pytest.mark.parametrize("file", [
    "dialect/arith.py", "kernel/bits.py", "sim/wheel.py", "networks/mesh/protocol/node.py",
    "networks/skin/verify/system.py", "networks/skin/invariants.py",
    "networks/radio/slotted/drive.py",
])  # fmt: skip
def test_an_edit_of_what_is_compiled_changes_the_cache(copied, file):
    before = compilation.source_hash(copied)
    (copied / file).write_text("# another\n")
    assert compilation.source_hash(copied) != before


def test_an_edit_of_anything_else_does_not(copied):
    before = compilation.source_hash(copied)
    for file in ("analysis/intervals.py", "networks/mesh/papers/lossy.py", "networks/mesh/run.py"):
        (copied / file).write_text("# another\n")
    assert compilation.source_hash(copied) == before


def test_the_same_sources_elsewhere_have_a_cache_of_their_own(copied):
    assert compilation.source_hash(copied) != compilation.source_hash()


def test_a_file_elsewhere_is_part_of_it(tmp_path):
    file = tmp_path / "token.py"
    found = []
    for text in ("a", "b"):
        file.write_text(text)
        found.append(compilation.source_hash(more=[file]))
    assert len({*found, compilation.source_hash()}) == 3


def test_only_what_the_cache_is_known_by_can_be_compiled(foreign):
    compilation.register(arith, node)
    assert not foreign
    with pytest.raises(RuntimeError, match=r"intervals\.py is compiled, and no part of"):
        compilation.register(intervals)


def test_functions_of_other_packages_are_noted_for_the_next_loop(foreign, tmp_path, monkeypatch):
    monkeypatch.setenv("INNERVATE_CACHE", str(tmp_path))
    before = compilation.numba.config.CACHE_DIR
    compilation.register_functions(lambda: None)
    assert {path.name for path in foreign} == {"test_compilation.py"}
    with_ours = compilation.open_cache()
    assert not foreign
    assert compilation.open_cache() != with_ours
    compilation.numba.config.CACHE_DIR = before
