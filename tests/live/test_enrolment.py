"""An authority: which numbers it gives, which serials, and whom it has put out; by its files."""

import errno
import os
from concurrent.futures import ThreadPoolExecutor

import pytest

from innervate.live import enrolment
from innervate.live import identity as identities
from innervate.live.enrolment import LIST, NUMBER_MAX, Authority, read_list
from innervate.live.errors import LiveError
from innervate.live.identity import REVOKED_MAX
from tests.live.pair import AUTHORITY, public_authority


@pytest.fixture
def folder(tmp_path):
    return tmp_path / "keys"


def test_serials_go_on_whoever_was_put_out_and_whoever_reads_the_folder(folder):
    first = Authority(folder)
    for number in (5, 0, NUMBER_MAX):
        first.enrol(number)
    first.revoke([5])
    again = Authority(folder)
    assert again.issued == [(5, 1), (0, 2), (NUMBER_MAX, 3)]
    assert (again.revoked, again.version) == ({1}, 1)
    path = again.enrol(5)
    assert path == folder / "n5.identity"
    own = identities.load(path, 5)
    assert (own.number, own.serial) == (5, 4)
    other = identities.load(folder / "n0.identity", 0)
    assert (own.authority, own.shared) == (other.authority, other.shared)
    assert own.exchange != other.exchange
    assert again.revoke([5, 0]).serials == {1, 2, 4}, "all that a node ever had"
    assert Authority(folder).version == 2


def test_who_enrols_while_somebody_else_does_takes_nothing_back(folder):
    """Who is not in the authority's file cannot be put out, nor who shares a serial alone."""
    first, second = Authority(folder), Authority(folder)
    first.enrol(0)
    second.enrol(1)
    assert first.revoke([1]).serials == {2}
    second.enrol(2)
    with pytest.raises(LiveError, match="node 2 is enrolled already"):
        first.enrol(2)
    again = Authority(folder)
    assert (again.issued, again.revoked) == ([(0, 1), (1, 2), (2, 3)], {2})
    one, two = (identities.load(folder / f"n{number}.identity", number) for number in (0, 1))
    assert one.authority == two.authority


def test_those_who_enrol_at_the_same_time_wait_for_each_other(folder):
    with ThreadPoolExecutor() as pool:
        made = list(pool.map(lambda number: Authority(folder).enrol(number), range(12)))
    serials = {identities.load(path, number).serial for number, path in enumerate(made)}
    assert serials == set(range(1, 13))
    assert sorted(Authority(folder).issued) == [
        (number, identities.load(path, number).serial) for number, path in enumerate(made)
    ]


@pytest.mark.parametrize("why", [errno.EBADF, errno.ENOLCK, errno.EOPNOTSUPP])
def test_where_a_folder_cannot_be_locked_nodes_are_enrolled_all_the_same(folder, monkeypatch, why):
    """As on NFS, which locks no folders."""

    def fails(*_):
        raise OSError(why, os.strerror(why))

    monkeypatch.setattr(enrolment.fcntl, "flock", fails)
    Authority(folder).enrol(1)
    assert Authority(folder).revoke([1]).serials == {1}


def test_an_authority_s_file_is_on_the_disk_before_it_replaces_the_old_one(folder, monkeypatch):
    """A power cut that leaves it empty would cost the whole network its authority."""
    done = []
    sync, replace = os.fsync, os.replace
    monkeypatch.setattr(os, "fsync", lambda fd: done.append("sync") or sync(fd))
    monkeypatch.setattr(os, "replace", lambda a, b: done.append(b.name) or replace(a, b))
    Authority(folder).enrol(3)
    assert done[:2] == ["sync", "authority.key"]


@pytest.mark.parametrize("number", [-1, NUMBER_MAX + 1])
def test_numbers_that_are_none(folder, number):
    with pytest.raises(LiveError, match=rf"numbers of nodes are 0 to 65534, not {number}"):
        Authority(folder).enrol(number)
    assert not folder.exists()


def test_who_has_a_number_keeps_it_until_he_is_put_out(folder):
    authority = Authority(folder)
    authority.enrol(3)
    text = (folder / "n3.identity").read_text()
    with pytest.raises(LiveError, match="node 3 is enrolled already; put it out first"):
        authority.enrol(3)
    assert (folder / "n3.identity").read_text() == text
    with pytest.raises(LiveError, match="node 4 was never enrolled"):
        authority.revoke([4])
    assert not (folder / LIST).exists()
    authority.issued = [(3, 7), (4, 2)]
    authority.enrol(5)
    assert authority.issued[-1] == (5, 8), "no serial stands for two"


def test_a_list_is_as_long_as_all_can_hand_it_on(folder, monkeypatch):
    authority = Authority(folder)
    authority.issued = [(number, number + 1) for number in range(REVOKED_MAX + 1)]
    whole = authority.revoke(list(range(REVOKED_MAX)))
    assert len(whole.serials) == REVOKED_MAX
    assert read_list(folder / LIST) == whole.data
    with pytest.raises(LiveError, match="65 are put out, and a list holds 64"):
        authority.revoke([REVOKED_MAX])
    assert read_list(folder / LIST) == whole.data


@pytest.mark.parametrize(("count", "is_read"), [(0, True), (REVOKED_MAX, True),
                                                (REVOKED_MAX + 1, False)])  # fmt: skip
def test_how_long_a_list_may_be_that_somebody_hands_on(count, is_read):
    made = identities.revoke(AUTHORITY, 7, frozenset(range(1, count + 1)))
    if is_read:
        assert identities.read_revoked(public_authority(), made.data) == made
    else:
        with pytest.raises(ValueError, match="no list of revoked nodes"):
            identities.read_revoked(public_authority(), made.data)


@pytest.mark.parametrize("text", ["", "key = 1", "[[[", 'key = "aa"\nshared = "bb"'])
def test_what_is_no_authority_is_refused_in_a_line(folder, text):
    Authority(folder).enrol(1)
    (folder / "authority.key").write_text(text)
    with pytest.raises(LiveError, match="not an authority's file; name another folder"):
        Authority(folder)


@pytest.mark.parametrize("text", ["no digits", "", "\n"])
def test_a_list_that_is_none(folder, text):
    folder.mkdir()
    (folder / LIST).write_text(text)
    with pytest.raises(LiveError, match="not a list of nodes that are put out"):
        read_list(folder / LIST)
    with pytest.raises(LiveError, match="cannot be read: No such file"):
        read_list(folder / "other")


def test_a_folder_that_lost_its_authority_gets_no_other_one(folder):
    Authority(folder).enrol(3)
    own = (folder / "n3.identity").read_text()
    (folder / "authority.key").unlink()
    with pytest.raises(LiveError, match=r"holds n3\.identity, and no authority"):
        Authority(folder)
    assert [path.name for path in folder.iterdir()] == ["n3.identity"]
    assert (folder / "n3.identity").read_text() == own


def test_an_authority_has_a_folder(tmp_path):
    (tmp_path / "keys").write_text("")
    with pytest.raises(LiveError, match="keys: a file lies here; name a folder"):
        Authority(tmp_path / "keys")
