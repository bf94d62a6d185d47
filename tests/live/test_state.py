"""What a node keeps is replaced as a whole, safe on the disk first; what goes wrong is said."""

import errno
import json

import pytest

from innervate.live.errors import LiveError
from innervate.live.machine import Machine, on
from innervate.live.state import State


class Disk(Machine):
    """This machine's disk: what was done to it in order, and what fails next."""

    def __init__(self):
        self.done, self.fails, self.now_ns = [], {}, 0

    def _do(self, what, path):
        self.done.append((what, path.name))
        if what in self.fails:
            raise OSError(self.fails[what], "No space left on device")

    def create(self, path):
        self._do("create", path)
        self.path = path
        return super().create(path)

    def sync(self, file):
        super().sync(file)
        self._do("sync", self.path)

    def replace(self, old, new):
        self._do("replace", old)
        super().replace(old, new)

    def remove(self, path):
        self._do("remove", path)
        super().remove(path)

    def monotonic_ns(self):
        return self.now_ns


@pytest.fixture
def disk():
    made = Disk()
    with on(made):
        yield made


@pytest.fixture
def path(tmp_path):
    return tmp_path / "n0.state"


def test_a_file_is_on_the_disk_before_it_takes_the_olds_place(disk, path):
    state = State(path)
    assert (state.fresh, state.epoch, state.revoked, state.numbers) == (True, 0, b"", -1)
    state.epoch, state.revoked, state.numbers = 255, b"\x01\xff", 65_535
    assert state.write() is True
    assert disk.done == [("create", "n0.state.new"), ("sync", "n0.state.new"),
                         ("replace", "n0.state.new")]  # fmt: skip
    assert json.loads(path.read_text()) == {"epoch": 255, "numbers": 65_535, "revoked": "01ff"}
    again = State(path)
    assert (again.fresh, again.epoch, again.revoked, again.numbers) == (
        False, 255, b"\x01\xff", 65_535,
    )  # fmt: skip


@pytest.mark.parametrize("step", ["create", "sync", "replace"])
def test_a_disk_that_is_full_leaves_the_old_file_and_no_other(disk, path, step):
    state = State(path)
    assert state.write()
    old = path.read_text()
    state.epoch = 7
    disk.fails[step] = errno.ENOSPC
    for failed in (1, 2):
        assert state.write() is False
        assert (state.trouble, state.failed) == ("No space left on device", failed)
        assert [one.name for one in path.parent.iterdir()] == ["n0.state"]
        assert path.read_text() == old
    state.check_place()  # a full disk is no wrong place
    disk.fails.clear()
    assert state.write() is True
    assert (state.trouble, state.failed) == ("", 2)
    assert json.loads(path.read_text())["epoch"] == 7


def test_what_is_set_aside_gives_the_next_life_all_but_the_numbers(disk, path):
    state = State(path)
    state.epoch, state.revoked, state.numbers = 9, b"\x07", 500
    assert state.write()
    disk.fails["sync"] = errno.ENOSPC
    state.set_aside()
    state.set_aside()
    assert [one.name for one in path.parent.iterdir()] == ["n0.state.old"]
    again = State(path)
    assert (again.fresh, again.epoch, again.revoked, again.numbers) == (False, 9, b"\x07", -1)
    assert not again.write()
    again.set_aside()
    assert State(path).epoch == 9
    disk.fails.clear()
    again.numbers = 700
    assert again.write()
    assert [one.name for one in path.parent.iterdir()] == ["n0.state"]
    assert State(path).numbers == 700


def test_of_two_files_that_a_power_cut_left_the_newer_is_set_aside(disk, path):
    for epoch, numbers in ((1, 100), (2, 200)):
        state = State(path)
        state.epoch, state.numbers = epoch, numbers
        disk.fails["remove"] = errno.EIO
        assert state.write()
        if epoch == 1:
            state.set_aside()
    assert len(list(path.parent.iterdir())) == 2
    again = State(path)
    again.set_aside()
    assert (State(path).epoch, State(path).numbers) == (2, -1)


def test_a_file_that_cannot_be_set_aside_stays(disk, path):
    State(path).set_aside()  # there is none
    state = State(path)
    assert state.write()
    disk.fails["replace"] = errno.EROFS
    state.set_aside()
    assert [one.name for one in path.parent.iterdir()] == ["n0.state"]
    State(None).set_aside()


def test_what_its_status_says(disk, path):
    state = State(path)
    assert state.status() == {"file": str(path), "written_s": None, "trouble": ""}
    disk.now_ns = 5_000_000_000
    state.write()
    disk.now_ns += 1_260_000_000
    assert state.status() == {"file": str(path), "written_s": 1.3, "trouble": ""}
    disk.fails["sync"] = errno.ENOSPC
    disk.now_ns += 1_000_000_000
    state.write()
    assert state.status()["written_s"] == 2.3
    assert state.status()["trouble"] == "No space left on device"
    assert State(None).status() is None
    assert State(None).write() is True


@pytest.mark.parametrize("number", [errno.ENOENT, errno.ENOTDIR, errno.EISDIR, errno.EACCES,
                                    errno.EPERM, errno.ELOOP])  # fmt: skip
def test_a_place_where_nothing_can_ever_be_written_is_refused(disk, path, number):
    state = State(path)
    state.check_place()
    disk.fails["create"] = number
    state.write()
    with pytest.raises(LiveError, match=r"n0\.state: cannot be written: No space left"):
        state.check_place()
    disk.fails.clear()
    state.write()
    state.check_place()


@pytest.mark.parametrize(
    ("kept", "is_sound"),
    [
        ({"epoch": 0}, True),
        ({"epoch": 255, "numbers": 65_535}, True),
        ({"epoch": 256}, False),
        ({"epoch": -1}, False),
        ({"epoch": 1, "numbers": -1}, True),
        ({"epoch": 1, "numbers": -2}, False),
        ({"epoch": 1, "numbers": 65_536}, False),
        ({"epoch": True}, False),
        ({"epoch": 1.0}, False),
        ({"epoch": 1, "revoked": "0"}, False),
        ({}, False),
    ],
)
def test_what_a_file_may_hold(disk, path, kept, is_sound):
    path.write_text(json.dumps(kept))
    if is_sound:
        state = State(path)
        assert (state.epoch, state.numbers) == (kept["epoch"], kept.get("numbers", -1))
    else:
        with pytest.raises(LiveError, match="not a node's state; remove it"):
            State(path)
