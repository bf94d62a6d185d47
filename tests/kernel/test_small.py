"""What the kernel does besides compiling, by hand: folders, interrupts, hashes, ranges, forms."""

import contextlib
import ctypes
import os
import signal
import threading
from collections import namedtuple
from types import SimpleNamespace

import numpy as np
import pytest

from innervate.dialect import plain
from innervate.kernel import bits, cache, compilation, ready, records, sources, tables
from innervate.kernel.clock import wall_s
from innervate.kernel.stop import Stop


def test_a_fingerprint_is_the_same_on_any_machine():
    assert bits.mix(0, 0) == 0
    word = (bits.FACTOR * 7) & bits.MASK64
    word ^= word >> 32
    assert bits.mix(3, 4) == bits.mix(4, 3) == word
    assert bits.mix(1, 0) == (bits.FACTOR ^ (bits.FACTOR >> 32)) - (1 << 64)  # it is signed
    assert bits.mix(-1, 0) == bits.mix(bits.MASK64, 0)


# Where compiled code is kept.


@pytest.fixture
def homes(monkeypatch, tmp_path):
    """Folders that are asked in turn, and those that cannot be written."""
    closed = set()
    monkeypatch.setattr(os, "access", lambda path, how: path not in closed)
    monkeypatch.setenv("INNERVATE_CACHE", str(tmp_path / "chosen"))
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "user"))
    monkeypatch.setattr(cache.tempfile, "gettempdir", lambda: str(tmp_path / "spare"))
    return closed


def test_the_first_folder_that_can_be_written_is_taken(homes, tmp_path, monkeypatch):
    chosen, user = tmp_path / "chosen", tmp_path / "user" / "innervate"
    assert cache.cache_root() == chosen
    homes.add(chosen)
    assert cache.cache_root() == user
    homes.add(user)
    assert cache.cache_root() == tmp_path / "spare" / f"innervate-{os.getuid()}"
    homes.clear()
    monkeypatch.delenv("INNERVATE_CACHE")
    assert cache.cache_root() == user
    monkeypatch.delenv("XDG_CACHE_HOME")
    monkeypatch.setenv("HOME", str(tmp_path / "home"))
    assert cache.cache_root() == tmp_path / "home" / ".cache" / "innervate"


def test_a_folder_that_cannot_be_made_is_passed_over(homes, tmp_path):
    (tmp_path / "chosen").touch()
    assert cache.cache_root() == tmp_path / "user" / "innervate"


def test_the_folders_that_were_used_last_are_kept(tmp_path):
    names = [f"{k:0{sources.NAME_LENGTH}d}" for k in range(compilation.CACHE_FOLDERS_MAX + 3)]
    for age, name in enumerate(names):
        (tmp_path / name).mkdir()
        os.utime(tmp_path / name, (1_000 - age, 1_000 - age))
    (tmp_path / "somebody's").mkdir()
    (tmp_path / ("f" * sources.NAME_LENGTH)).touch()
    own = names[-1]  # the oldest, and the one that is in use
    compilation._forget_old(tmp_path / own)
    left = {path.name for path in tmp_path.iterdir()}
    most = compilation.CACHE_FOLDERS_MAX - 1
    assert left == {*names[:most], own, "somebody's", "f" * sources.NAME_LENGTH}


@pytest.mark.parametrize(("is_ready", "not_kept", "is_marked"), [
    (False, [], True), (True, [], False), (False, ["loop"], False),
])  # fmt: skip
def test_a_loop_is_marked_as_compiled_if_it_was_kept(
    monkeypatch, tmp_path, is_ready, not_kept, is_marked
):
    import numba

    monkeypatch.setenv("INNERVATE_CACHE", str(tmp_path))
    folder = tmp_path / compilation.source_hash()
    folder.mkdir()
    monkeypatch.setattr(numba.config, "CACHE_DIR", str(folder))
    monkeypatch.setattr(compilation, "_not_kept", not_kept)
    monkeypatch.setattr(ready, "is_ready", lambda name: is_ready and name == "mine")
    compilation.mark_compiled("mine")
    assert (folder / "mine.compiled").exists() == is_marked
    assert compilation.is_compiled("mine") == (is_marked or is_ready)
    assert not compilation.is_compiled("other")


def test_of_equal_names_under_one_roof_the_first_counts():
    def one():
        return 1

    def other():
        return 2

    other.__name__ = "one"
    made = compilation.bound("roof", [one], [other])
    assert (made.__name__, made.one()) == ("roof", 1)


def test_only_what_was_imported_from_the_toolkit_is_its_own():
    assert compilation.is_own(bits)
    copy = type(bits)("innervate.kernel.bits")
    assert not compilation.is_own(copy)
    assert not compilation.is_own(os)


def test_modules_are_those_whose_functions_are_called_directly_or_not():
    from innervate.dialect import arith, outbox
    from innervate.networks.skin.protocol import cell, route

    found = compilation.modules_of(cell)
    assert found[0] is cell
    assert {arith, outbox, route} <= set(found)
    assert len(found) == len(set(found))


# Sources.


@pytest.fixture
def tree(tmp_path):
    for name in ("sim/a.py", "sim/in/b.py", "networks/x/protocol/c.py", "networks/x/invariants.py",
                 "networks/x/run.py", "web/d.py", "networks/e.py", "sim/f.txt"):  # fmt: skip
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(name)
    return tmp_path


def test_sources_of_compiled_code_are_rooms_and_parts_of_networks(tree):
    found = [path.relative_to(tree).as_posix() for path in sources.source_files(tree)]
    assert found == [
        "networks/x/invariants.py",
        "networks/x/protocol/c.py",
        "sim/a.py",
        "sim/in/b.py",
    ]


def test_a_hash_is_of_words_places_and_texts(tree, tmp_path):
    files = sources.source_files(tree)
    before = sources.hash_of("", files, tree)
    assert (len(before), before) == (sources.NAME_LENGTH, sources.content_hash(tree))
    assert sources.hash_of("more", files, tree) != before
    assert sources.hash_of("", files[1:], tree) != before
    files[0].write_text("another")
    assert sources.hash_of("", files, tree) != before
    gone = [tmp_path / "none.py"]
    assert sources.hash_of("", gone) != sources.hash_of("", [tmp_path / "nine.py"])


# Interrupts.


def test_an_interrupt_is_asked_for_and_then_as_before():
    before = signal.getsignal(signal.SIGINT)
    with Stop() as stop:
        assert not stop.asked
        signal.raise_signal(signal.SIGINT)
        assert stop.asked
    assert signal.getsignal(signal.SIGINT) is before
    assert wall_s() <= wall_s()


def test_who_interrupts_once_more_waits_no_longer():
    with Stop() as stop:
        signal.raise_signal(signal.SIGINT)
        with pytest.raises(KeyboardInterrupt):
            signal.raise_signal(signal.SIGINT)
    assert stop.asked


def test_compiling_ends_at_once(monkeypatch, tmp_path):
    """It takes half a minute in which nobody looks whether an end was asked for."""

    @contextlib.contextmanager
    def interrupted(_lock):
        signal.raise_signal(signal.SIGINT)
        yield

    monkeypatch.setenv("INNERVATE_CACHE", str(tmp_path))
    monkeypatch.setattr(compilation, "alone", interrupted)
    doubled = compilation.compiled(lambda number: 2 * number)
    with Stop() as stop:
        with pytest.raises(KeyboardInterrupt):
            doubled(3)
        assert not stop.asked
        monkeypatch.undo()
        signal.raise_signal(signal.SIGINT)
        with pytest.raises(KeyboardInterrupt):  # nor does it begin
            doubled(3)
    assert doubled(3) == 6


def test_another_thread_catches_none():
    seen = []

    def work():
        before = signal.getsignal(signal.SIGINT)
        with Stop() as stop:
            seen.append((stop.asked, signal.getsignal(signal.SIGINT) is before))

    thread = threading.Thread(target=work)
    thread.start()
    thread.join()
    assert seen == [(False, True)]


# Ranges of plain records.

FIELDS = (("mode", 0, 2, 9, "", ""), ("dist", 3, 0, 31, "", ""), ("way", 2, -7, -4, "", ""))


@pytest.mark.parametrize(("name", "place", "value"), [
    ("mode", None, 10), ("mode", None, 1), ("dist", 0, -1), ("dist", 2, 32), ("way", 1, -3),
    ("way", 0, -8),
])  # fmt: skip
def test_ranges_are_looked_at_again_whenever_something_has_changed(name, place, value):
    twin = plain.make("Twin", FIELDS)()
    words = records.Words(twin, FIELDS)
    for _ in range(2):
        assert words.are_declared()
    before = getattr(twin, name) if place is None else getattr(twin, name)[place]
    for now, is_declared in ((value, False), (value, False), (before, True), (value, False)):
        if place is None:
            setattr(twin, name, now)
        else:
            getattr(twin, name)[place] = now
        assert words.are_declared() == is_declared


def test_a_record_without_fields_is_in_its_range():
    twin = plain.make("Twin", ())()
    assert records.Words(twin, ()).are_declared()


# Tables and forms.

World = namedtuple("World", "a b")
Inner = namedtuple("Inner", "x")


def test_a_table_borrows_memory_as_it_lies():
    numbers = np.arange(5)
    lent = tables.borrowed(World(numbers, Inner(numbers[2:])))
    assert isinstance(lent, World)
    assert (lent.a.length, lent.b.x.length) == (5, 3)
    assert lent.b.x.address - lent.a.address == 16
    assert lent.a.array is numbers
    with pytest.raises(ValueError, match="contiguous"):
        tables.borrowed((numbers[::2],))


def test_a_form_is_of_names_kinds_places_and_shapes_but_not_of_lengths():
    def form(kind=np.int64, shape=(4,), outer=World, inner=Inner):
        return ready.form_of(outer(np.zeros(shape, kind), inner(np.zeros(2, np.int32))))

    usual = form()
    assert form(shape=(9,)) == usual
    row = [("a", np.int32), ("b", np.int64, (3,))]
    others = [
        form(np.int32), form(shape=(4, 2)), form(shape=(4, 3)), form(row),
        form(np.dtype(row, align=True)), form([("a", np.int32), ("b", np.int64, (2,))]),
        form([("a", np.int32), ("c", np.int64, (3,))]),
        form(inner=namedtuple("Inner", "y")), form(outer=namedtuple("Other", "a b")),
    ]  # fmt: skip
    assert len({usual, *others}) == len(others) + 1
    world = World(np.zeros(4), Inner(np.zeros(2)))
    assert [len(one) for one in ready._arrays(world)] == [4, 2]
    assert ready.key_of("one", world) != ready.key_of("other", world)


@pytest.mark.parametrize(("system", "machine", "most", "found"), [
    ("linux", "AMD64", 2**63 - 1, "linux-x86_64"), ("darwin", "arm64", 2**63 - 1, "darwin-aarch64"),
    ("linux", "riscv64", 2**63 - 1, "linux-riscv64"),
    ("linux", "x86_64", 2**31 - 1, "linux-x86_64-32"),
])  # fmt: skip
def test_what_a_loop_is_made_for_is_system_and_processor(monkeypatch, system, machine, most, found):
    monkeypatch.setattr(ready.sys, "platform", system)
    monkeypatch.setattr(ready.sys, "maxsize", most)
    monkeypatch.setattr(ready.platform, "machine", lambda: machine)
    assert ready.target() == found
    is_known = found.endswith("-x86_64")
    assert ready.baseline() == (ready.BASELINES["x86_64"] if is_known else ready.ANY)


def test_a_loop_is_loaded_once_for_each_form_and_compiled_once(monkeypatch):
    asked, ran = [], []

    def load(name, world):
        asked.append((name, ready.form_of(world)))
        if world.a.dtype == np.int64:
            return lambda arrays, until, budget: ran.append((len(arrays), until, budget))
        return None

    def compiled():
        ran.append("made")
        return lambda world, until, budget: ran.append((world, until, budget))

    monkeypatch.setattr(ready, "load", load)
    loop = ready.Loop("mine", compiled)
    fits = World(np.zeros(2, np.int64), np.zeros(3))
    for length in (2, 5):
        loop(World(np.zeros(length, np.int64), fits.b), 7, 8)
    assert (len(asked), ran) == (1, [(2, 7, 8)] * 2)
    other = World(np.zeros(2, np.int32), np.zeros(3))
    loop(other, 1, 2)
    loop(fits, 3, 4)  # once something is compiled, that is what runs
    assert ran[2:] == ["made", (other, 1, 2), (fits, 3, 4)]
    unnamed = ready.Loop("", compiled)
    unnamed(fits, 5, 6)
    assert (ran[5:], len(asked)) == (["made", (fits, 5, 6)], 2)


@pytest.mark.parametrize("to", ["LOCK_EX", "LOCK_SH"])
def test_nobody_else_compiles_or_even_looks_while_one_is_alone(tmp_path, to):
    fcntl = pytest.importorskip("fcntl", reason="files are locked as on POSIX")
    wanted = getattr(fcntl, to) | fcntl.LOCK_NB
    path = tmp_path / "loop.lock"
    with path.open("ab") as other:
        with cache.alone(path), pytest.raises(BlockingIOError):
            fcntl.flock(other, wanted)
        fcntl.flock(other, wanted)


@pytest.mark.parametrize(("status", "is_fine"), [(0, True), (-2, True), (1, False), (-1, False)])
def test_a_ready_loop_is_handed_addresses_lengths_and_limits(status, is_fine):
    seen = []
    number = ctypes.c_int64
    code = ctypes.CFUNCTYPE(ctypes.c_int32, *[number] * 8)(
        lambda _result, _failure, *given: seen.append(given) or status
    )
    advance = ready.called(ctypes.cast(code, ctypes.c_void_p).value, 2)
    arrays = [np.arange(3), np.zeros(5)]
    if is_fine:
        advance(arrays, np.int64(70), 9)
    else:
        with pytest.raises(RuntimeError, match=f"ended with status {status}"):
            advance(arrays, 70, 9)
    assert seen == [(arrays[0].ctypes.data, 3, arrays[1].ctypes.data, 5, 70, 9)]


def test_a_world_that_is_lent_again_is_not_looked_at_again():
    asked, ran = [], []
    compiled = SimpleNamespace(
        overloads={}, typeof_pyval=lambda value: asked.append(value) or "kind",
        compile=lambda kinds: lambda *given: ran.append((kinds, *given[1:])),
    )  # fmt: skip
    loop = tables.Lending(compiled)
    one, other = World(np.zeros(2), Inner(np.zeros(3))), World(np.zeros(2), Inner(np.zeros(3)))
    for world, looks in ((one, 3), (one, 3), (other, 6), (one, 9)):
        loop(world, 7, 8)
        assert len(asked) == looks
    assert ran == [(("kind",) * 3, 7, 8)] * 4
