import os
import stat

import pytest

from innervate.running import RunError, default_folder
from innervate.running.folder import (
    PROVENANCE,
    REQUIRED,
    SCENARIO,
    SUMMARY,
    check_target,
    read_json,
    replacing,
    write_json,
)


def make_run(folder, text="old"):
    folder.mkdir(parents=True)
    for name in REQUIRED:
        (folder / name).write_text(text)


def write_run(folder, text="new"):
    with replacing(folder) as fresh:
        for name in REQUIRED:
            (fresh / name).write_text(text)


def fail_to_write(folder, error):
    with replacing(folder) as fresh:
        (fresh / SUMMARY).write_text("half")
        raise error


def test_appears_whole(tmp_path):
    target = tmp_path / "a" / "run"
    with replacing(target) as fresh:
        (fresh / SUMMARY).write_text("half")
        assert not target.exists()
        assert fresh.parent == target.parent
    assert (target / SUMMARY).read_text() == "half"
    assert os.listdir(target.parent) == ["run"]


@pytest.mark.parametrize("error", [ValueError, KeyboardInterrupt])
def test_nothing_half_written(tmp_path, error):
    target = tmp_path / "run"
    with pytest.raises(error):
        fail_to_write(target, error)
    assert os.listdir(tmp_path) == []


def test_an_old_run_stays_if_the_new_one_fails(tmp_path):
    make_run(tmp_path / "run")
    with pytest.raises(ValueError, match="broke"):
        fail_to_write(tmp_path / "run", ValueError("broke"))
    assert (tmp_path / "run" / SUMMARY).read_text() == "old"
    assert os.listdir(tmp_path) == ["run"]


def test_an_old_run_stays_if_the_last_step_fails(tmp_path, monkeypatch):
    make_run(tmp_path / "run")
    rename = type(tmp_path).rename

    def failing(path, target):
        if str(target).endswith("run") and not path.name.endswith(".old"):
            raise OSError(28, "No space left on device")
        return rename(path, target)

    monkeypatch.setattr(type(tmp_path), "rename", failing)
    with pytest.raises(RunError, match="No space left"):
        write_run(tmp_path / "run")
    assert (tmp_path / "run" / SUMMARY).read_text() == "old"
    assert os.listdir(tmp_path) == ["run"]


def test_replaces_a_run(tmp_path):
    make_run(tmp_path / "run")
    (tmp_path / "run" / "routes.parquet").write_text("old")
    write_run(tmp_path / "run")
    assert sorted(os.listdir(tmp_path / "run")) == sorted(REQUIRED)
    assert (tmp_path / "run" / SUMMARY).read_text() == "new"
    assert os.listdir(tmp_path) == ["run"]


def test_fills_an_empty_folder(tmp_path):
    (tmp_path / "run").mkdir()
    write_run(tmp_path / "run")
    assert (tmp_path / "run" / SCENARIO).exists()


def test_permissions_are_the_usual_ones(tmp_path):
    write_run(tmp_path / "run")
    (tmp_path / "plain").mkdir()
    modes = [stat.S_IMODE((tmp_path / name).stat().st_mode) for name in ("run", "plain")]
    assert modes[0] == modes[1]


def test_leaves_other_folders_alone(tmp_path):
    (tmp_path / "thesis.tex").write_text("years of work")
    with pytest.raises(RunError, match="not a run folder and not empty"):
        write_run(tmp_path)
    assert os.listdir(tmp_path) == ["thesis.tex"]


def test_leaves_notes_in_a_run_folder_alone(tmp_path):
    make_run(tmp_path / "run")
    (tmp_path / "run" / "notes.txt").write_text("mine")
    with pytest.raises(RunError, match=r"also holds notes\.txt; move it away"):
        write_run(tmp_path / "run")
    assert (tmp_path / "run" / "notes.txt").read_text() == "mine"


def test_files_in_the_way(tmp_path):
    (tmp_path / "file").write_text("")
    for target in (tmp_path / "file", tmp_path / "file" / "run"):
        with pytest.raises(RunError, match="choose another"):
            check_target(target)


@pytest.mark.parametrize("name", ["a\0b", "x" * 300])
def test_impossible_names(tmp_path, name):
    with pytest.raises(RunError) as caught:
        check_target(tmp_path / name)
    assert "\n" not in str(caught.value)
    assert "\0" not in str(caught.value)
    why = "no such path can be" if "\0" in name else "File name too long"
    assert str(caught.value).endswith(f": {why}; choose another folder")


def test_through_a_link(tmp_path):
    make_run(tmp_path / "real")
    (tmp_path / "latest").symlink_to(tmp_path / "real")
    write_run(tmp_path / "latest")
    assert (tmp_path / "latest").is_symlink()
    assert (tmp_path / "real" / SUMMARY).read_text() == "new"


@pytest.mark.parametrize(
    ("name", "folder"),
    [
        ("setup-1", "runs/setup-1-7"),
        ("../../etc", "runs/etc-7"),
        ("my skin/left arm", "runs/my-skin-left-arm-7"),
        ("", "runs/skin-7"),
        ("...", "runs/skin-7"),
        ("haut \u00e4", "runs/haut-\u00e4-7"),
    ],
)
def test_default_names(name, folder):
    assert default_folder(name, 7).as_posix() == folder


def test_json_of_a_folder(tmp_path):
    write_json(tmp_path / SUMMARY, {"a": None})
    assert read_json(tmp_path, SUMMARY) == {"a": None}
    with pytest.raises(RunError, match=r"has no provenance\.json"):
        read_json(tmp_path, PROVENANCE)
    for damaged in ("{", "[]"):
        (tmp_path / SUMMARY).write_text(damaged)
        with pytest.raises(RunError, match="damaged"):
            read_json(tmp_path, SUMMARY)
    (tmp_path / SUMMARY).write_bytes(b"\xff\xfe")
    with pytest.raises(RunError, match="damaged"):
        read_json(tmp_path, SUMMARY)


@pytest.mark.parametrize("missing", [os.W_OK, os.X_OK])
def test_a_folder_is_written_into_by_who_may_write_and_enter_the_one_it_comes_into(
    tmp_path, monkeypatch, missing
):
    """Whoever is root may always: so it is said here what is not allowed."""
    monkeypatch.setattr(os, "access", lambda _, mode: not mode & missing)
    with pytest.raises(RunError, match="no permission to write in"):
        check_target(tmp_path / "run")
    monkeypatch.setattr(os, "access", lambda *_: True)
    assert check_target(tmp_path / "run") == (tmp_path / "run").resolve()
