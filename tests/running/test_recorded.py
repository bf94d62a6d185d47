"""Run folders that somebody has damaged: a line for each, whoever reads them."""

import json

import pytest

from innervate import running
from innervate.cli import exporting
from innervate.running import RunError
from innervate.web import recorded

RADIO = 'kind = "radio"\nstations = 2\nduration_s = 1\n'


def compared(folder):
    return running.compare(folder, folder)


def exported(folder):
    return exporting._Source(str(folder), [], None)


READERS = [compared, exported, recorded.plan_of]


def put(folder, **summary):
    (folder / "scenario.toml").write_text(RADIO)
    (folder / "summary.json").write_text(json.dumps({"kind": "radio", "duration_s": 1} | summary))
    (folder / "provenance.json").write_text("{}")


@pytest.mark.parametrize("read", READERS)
@pytest.mark.parametrize("at_s", ["x", float("nan"), float("inf"), -1, True, 10**30, []])
def test_a_moment_that_is_none(tmp_path, read, at_s):
    put(tmp_path, interrupted_at_s=0.5)
    assert read(tmp_path)
    put(tmp_path, interrupted_at_s=at_s)
    with pytest.raises(RunError, match=r": its summary is damaged; run the scenario again$"):
        read(tmp_path)


@pytest.mark.parametrize("read", READERS)
def test_a_folder_without_a_scenario_is_no_run_folder(tmp_path, read):
    put(tmp_path)
    (tmp_path / "scenario.toml").unlink()
    with pytest.raises(RunError, match=r" is not a run folder: it has no scenario\.toml$"):
        read(tmp_path)
