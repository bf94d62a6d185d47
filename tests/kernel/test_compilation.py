"""Compilation: what the cache of compiled code is known by, so that none of it is stale."""

import ast
import gc
import importlib
import inspect
import os
import shutil
import subprocess
import sys
from contextlib import suppress
from pathlib import Path
from types import ModuleType

import numba
import numpy as np
import pytest
from llvmlite.binding import Linkage

from innervate.analysis import intervals
from innervate.dialect import arith
from innervate.kernel import cache, compilation, linking, sources
from innervate.kernel.linking import as_one
from innervate.network import networks
from innervate.networks.mesh.protocol import node
from innervate.sim.cables import declared


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
    "networks/radio/slotted/drive.py", "networks/radio/scenario/baselines.py",
    "scenario/actions/channel.py", "topology/placement.py",
])  # fmt: skip
def test_an_edit_of_what_is_compiled_changes_the_cache(copied, file):
    before = compilation.source_hash(copied)
    (copied / file).write_text("# another\n")
    assert compilation.source_hash(copied) != before


PLAIN = {"networks/skin/sim/script.py", "networks/skin/verify/assumptions.py"}  # never compiled


def numbers_taken(path):
    """(module, name) of the whole numbers that a file takes from other modules of the toolkit."""
    tree = ast.parse(path.read_text())
    used = {(one.value.id, one.attr) for one in ast.walk(tree)
            if isinstance(one, ast.Attribute) and isinstance(one.value, ast.Name)}  # fmt: skip
    for part in ast.walk(tree):
        if isinstance(part, ast.ImportFrom) and part.module.startswith("innervate"):
            module = importlib.import_module(part.module)
            for alias in part.names:
                thing, known = getattr(module, alias.name, None), alias.asname or alias.name
                yield from ((thing, name) for of, name in used
                            if of == known and isinstance(getattr(thing, name, None), int)
                            and isinstance(thing, ModuleType))  # fmt: skip
                if alias.name.isupper() and isinstance(thing, int):
                    yield module, alias.name


def file_that_says(module, name):
    """Where a number is written, however many modules have it from there."""
    for part in ast.parse(inspect.getsource(module)).body:
        if isinstance(part, ast.ImportFrom) and name in [one.name for one in part.names]:
            return file_that_says(importlib.import_module(part.module), name)
    return Path(module.__file__).relative_to(sources.ROOT).as_posix()


def test_the_cache_is_known_by_all_files_whose_numbers_are_compiled_in():
    files = {path.relative_to(sources.ROOT).as_posix() for path in sources.source_files()}
    rooms = [file for file in files if "scenario" not in file and file not in PLAIN]
    taken = {one for file in rooms for one in numbers_taken(sources.ROOT / file)}
    said = {(file_that_says(module, name), name) for module, name in taken}
    assert {("dialect/arith.py", "MASK30"), ("scenario/actions/channel.py", "JOIN")} <= said
    assert {(file, name) for file, name in said if file not in files} == set()


def test_an_edit_of_anything_else_does_not(copied):
    before = compilation.source_hash(copied)
    for file in ("analysis/intervals.py", "networks/mesh/papers/lossy.py", "networks/mesh/run.py"):
        (copied / file).write_text("# another\n")
    assert compilation.source_hash(copied) == before


def test_the_same_sources_elsewhere_have_a_cache_of_their_own(copied):
    assert compilation.source_hash(copied) != compilation.source_hash()


def test_each_state_of_a_file_elsewhere_has_a_folder_of_its_own(foreign, tmp_path, monkeypatch):
    monkeypatch.setenv("INNERVATE_CACHE", str(tmp_path / "cache"))
    before = numba.config.CACHE_DIR
    file, found = tmp_path / "token.py", []
    ours = compilation.open_cache()
    (ours / "loop.compiled").touch()
    for number in range(compilation.CACHE_FOLDERS_MAX + 3):
        file.write_text(f"A = {number}")
        foreign.add(file)
        found.append(compilation.open_cache())
    assert len(set(found)) == len(found)
    assert {folder.parent for folder in found} == {ours}
    kept = [folder for folder in found if folder.exists()]
    assert len(kept) == compilation.CACHE_FOLDERS_MAX
    assert kept[-1] == found[-1]
    assert (ours / "loop.compiled").exists()  # edits push out what was compiled of older edits only
    numba.config.CACHE_DIR = before


def test_only_what_the_cache_is_known_by_can_be_compiled(foreign):
    compilation.register(arith, node)
    assert not foreign
    with pytest.raises(RuntimeError, match=r"intervals\.py is compiled, and no part of"):
        compilation.register(intervals)


def test_functions_of_other_packages_are_noted_for_the_next_loop(foreign, tmp_path, monkeypatch):
    monkeypatch.setenv("INNERVATE_CACHE", str(tmp_path))
    before = numba.config.CACHE_DIR
    compilation.register_functions(lambda: None)
    assert {path.name for path in foreign} == {"test_compilation.py"}
    with_ours = compilation.open_cache()
    assert not foreign
    assert compilation.open_cache() != with_ours
    numba.config.CACHE_DIR = before


def test_numbers_of_other_packages_are_what_the_next_loop_is_known_by(
    foreign, tmp_path, monkeypatch
):
    monkeypatch.setenv("INNERVATE_CACHE", str(tmp_path))
    monkeypatch.setattr(numba.config, "CACHE_DIR", "")
    sizes, times = ModuleType("sizes"), ModuleType("times")
    known = {"STEP": 1, "PLACES": (1, 2), "sizes": sizes, "times": times, "MOST": 9}
    text = "def f(n):\n    return n + STEP + PLACES[0] + sizes.FAR + times.FAR"
    exec(compile(text, "/ring/f.py", "exec"), known)

    def folder(step=1, places=(1, 2), far=3, late=5, most=9):
        known.update(STEP=step, PLACES=places, MOST=most)
        sizes.FAR, times.FAR = far, late
        compilation.register_functions(known["f"])
        return compilation.open_cache()

    assert folder() == folder(most=8)  # it does not look at that one
    others = [folder(step=2), folder(places=(1, 3)), folder(far=4), folder(far=5, late=3)]
    assert len({folder(), *others}) == 5


@pytest.fixture
def own_cache(tmp_path, monkeypatch):
    """A cache that holds nothing yet."""
    monkeypatch.setattr(numba.config, "CACHE_DIR", numba.config.CACHE_DIR)
    monkeypatch.setenv("INNERVATE_CACHE", str(tmp_path))
    return tmp_path


def test_where_nothing_can_be_written_nobody_waits(tmp_path):
    with compilation.alone(tmp_path / "no such folder" / "loop.lock"):
        pass
    assert list(tmp_path.iterdir()) == []


def test_a_loop_is_compiled_alone_and_once(own_cache, monkeypatch):
    def increased(number):
        return number + 1

    entered = []
    wait = compilation.alone
    monkeypatch.setattr(compilation, "alone", lambda path: entered.append(path) or wait(path))
    one, other = compilation.compiled(increased), compilation.compiled(increased)
    assert (one(1), one(2), other(1)) == (2, 3, 2)
    assert (sum(one.stats.cache_misses.values()), sum(other.stats.cache_hits.values())) == (1, 1)
    assert len(entered) == 2  # to compile, and to load what is compiled
    assert len(set(entered)) == 1
    assert entered[0].parent == Path(numba.config.CACHE_DIR)


@pytest.mark.parametrize("way", [compilation.compiled, compilation.compiled_as_one])
def test_what_has_references_has_them_counted(own_cache, way):
    def same(array):
        kept = array
        return kept

    compiled = way(same)
    array = np.zeros(3)
    before = sys.getrefcount(array)
    for _ in range(10):
        compiled(array)
    assert sys.getrefcount(array) == before


def twice(number):
    return 2 * number


def test_what_cannot_be_kept_runs_all_the_same(tmp_path, monkeypatch, full_disk):
    monkeypatch.setenv("INNERVATE_CACHE", str(tmp_path))
    monkeypatch.setattr(compilation, "_not_kept", [])
    made = compilation.compiled_as_one(twice)
    with full_disk():
        assert made(21) == 42
    compilation.mark_compiled("mine")
    assert not compilation.is_compiled("mine")  # the next process says that it compiles


def four_times(number):
    return twice(twice(number))


def test_what_is_linked_into_a_loop_belongs_to_it_alone(own_cache, monkeypatch):
    """Otherwise each call is handed all tables of a world: half the time of some loops.

    It is all optimised once, with the loop, or large loops would take minutes.
    """
    optimise, linked, optimised = linking._numbas_optimize, {}, []

    def looked_at(library):
        optimised.append(library.name)
        for one in library._final_module.functions:
            if "test_compilation" in one.name and not one.is_declaration:
                linked.setdefault(one.linkage, []).append(one.name)
        optimise(library)

    monkeypatch.setattr(linking, "_numbas_optimize", looked_at)
    compilation.register_functions(twice, hot=False)
    assert compilation.compiled_as_one(four_times)(3) == 12
    assert any("twice" in name for name in linked[Linkage.internal])
    assert Linkage.linkonce_odr not in linked
    assert optimised == ["four_times"]


MAKES_ARRAYS = """
import numpy as np
from numba.core.runtime import rtsys

from innervate.kernel import compilation


def ones(count):
    return np.ones(count)


def total(count):
    result = 0.0
    for size in range(count):
        result += ones(size).sum()
    return result


compilation.register_functions(ones, hot=False)
print(compilation.compiled_as_one(total)(100))
made = rtsys.get_allocation_stats()
print(made.mi_alloc - made.mi_free)
"""


def test_the_first_loop_of_a_process_may_make_arrays(tmp_path):
    """Once they ended the process: Numba's runtime had been left to be linked later."""
    script = tmp_path / "makes_arrays.py"
    script.write_text(MAKES_ARRAYS)
    env = os.environ | {"INNERVATE_CACHE": str(tmp_path), "NUMBA_NRT_STATS": "1"}
    done = subprocess.run([sys.executable, str(script)], env=env, capture_output=True, text=True)
    assert (done.returncode, done.stdout.split()) == (0, ["4950.0", "0"]), done.stderr


BOUND = """
from innervate.kernel.compilation import told
from innervate.networks.radio.sim import simulate, stacks
from innervate.sim.channel import loop

made = simulate.registered(stacks.PROTOCOLS["csma-cd-r/practical"], simulate.traffic)
print(told(loop.bind(made)))
"""


def test_a_loop_is_known_by_the_same_words_whether_its_sources_were_translated_before(copied):
    """By Numba's own key it is not: who edited a file waited for the compiler twice."""
    env = {name: os.environ[name] for name in os.environ if name != "PYTHONDONTWRITEBYTECODE"}
    env |= {"PYTHONPATH": str(copied.parent)}
    at_first, again = (
        subprocess.run([sys.executable, "-c", BOUND], env=env, capture_output=True, text=True)
        for _ in range(2)
    )
    assert list(copied.rglob("loop.*.pyc"))
    assert "practical" in at_first.stdout, at_first.stderr
    assert at_first.stdout == again.stdout


def test_loops_that_are_bound_otherwise_are_told_apart():
    def bound_to(value):
        def called(world):
            return world + value

        return compilation.bound("a stack", [called])

    def written(number):
        made = {}
        exec(f"def called(world):\n    return world + {number}\n", made)
        return compilation.bound("a stack", [made["called"]])

    def around(do):
        return lambda world: do.called(world)

    tables = np.arange(2000), np.arange(2000)
    tables[1][1000] = 0
    others = [around(bound_to(value)) for value in (1, 2, None, (1, 2), arith, *tables)]
    others += [around(written(number)) for number in (1, 2)]
    told = [repr(compilation.told(one)) for one in others]
    assert len(set(told)) == len(told)
    assert repr(compilation.told(around(bound_to(1)))) == told[0]


@pytest.mark.parametrize("collects", [True, False])
def test_while_a_loop_is_compiled_nothing_is_collected_and_then_as_before(collects):
    before = gc.isenabled()
    try:
        (gc.enable if collects else gc.disable)()
        with suppress(KeyError), as_one("a loop"):
            assert not gc.isenabled()
            raise KeyError
        assert gc.isenabled() == collects
    finally:
        (gc.enable if before else gc.disable)()


def test_a_cache_folder_is_made_with_those_above_it(monkeypatch, tmp_path):
    wanted = tmp_path / "a" / "b"
    monkeypatch.setenv("INNERVATE_CACHE", str(wanted))
    assert cache.cache_root() == wanted
    assert wanted.is_dir()
    assert cache.cache_root() == wanted  # there already


def test_a_network_that_is_set_up_and_not_run_has_no_part_in_what_is_compiled_next():
    """The toolkit's own loops were compiled anew then, in a folder of that network."""
    folder = compilation.open_cache()
    declared.compiled_loop.__wrapped__(networks()["babel"])
    assert compilation.open_cache() == folder
