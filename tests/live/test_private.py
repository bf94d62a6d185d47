"""Files and folders of one user: who may read them, whatever was there before."""

import os
import stat

import pytest

from innervate.live import private
from innervate.live.errors import LiveError


def mode(path):
    return stat.S_IMODE(path.stat().st_mode)


@pytest.mark.parametrize("before", [None, "a longer text than that", ""])
def test_a_file_has_what_is_written_and_its_owner_alone_may_read_it(tmp_path, before):
    path = tmp_path / "key"
    if before is not None:
        path.write_text(before)
        path.chmod(0o664)
    private.write(path, "new")
    assert path.read_text() == "new"
    assert mode(path) == 0o600


def test_what_is_no_file_keeps_its_mode(tmp_path):
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    pipe.chmod(0o622)
    reader = os.open(pipe, os.O_RDONLY | os.O_NONBLOCK)
    private.write(pipe, "told")
    assert os.read(reader, 99) == b"told"
    os.close(reader)
    assert mode(pipe) == 0o622


@pytest.mark.parametrize(("rights", "ours"), [
    (0o700, True), (0o755, True), (0o720, False), (0o702, False), (0o777, False),
])  # fmt: skip
def test_a_folder_that_others_may_change_is_not_ours_alone(tmp_path, rights, ours):
    folder = tmp_path / "nodes"
    assert private.checked(folder) == folder  # not there yet
    folder.mkdir()
    folder.chmod(rights)
    if ours:
        assert private.checked(folder) == folder
    else:
        with pytest.raises(LiveError, match="not ours alone"):
            private.checked(folder)


def test_a_file_a_link_and_somebody_elses_folder_are_refused(tmp_path, monkeypatch):
    (tmp_path / "file").touch(0o600)
    (tmp_path / "link").symlink_to(tmp_path)
    for name in ("file", "link"):
        with pytest.raises(LiveError, match=f"{name}: this folder is not ours"):
            private.checked(tmp_path / name)
    with pytest.raises(LiveError, match="cannot be looked at: Not a directory"):
        private.checked(tmp_path / "file" / "nodes")
    private.checked(tmp_path)
    monkeypatch.setattr(os, "getuid", lambda: tmp_path.stat().st_uid + 1)
    with pytest.raises(LiveError, match="not ours alone"):
        private.checked(tmp_path)
