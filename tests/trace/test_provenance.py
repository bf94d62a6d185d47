import hashlib
import json
import os
import platform
import subprocess
from pathlib import Path

import innervate
from innervate.kernel.clock import wall_s
from innervate.trace import provenance as provenance_module
from innervate.trace.provenance import checkout, provenance


def git(folder, *words):
    identity = ["-c", "user.name=t", "-c", "user.email=t@example.org", "-c", "commit.gpgsign=false"]
    subprocess.run(["git", "-C", str(folder), *identity, *words], check=True, capture_output=True)


def test_what_it_says():
    said = provenance(
        scenario_toml='kind = "skin"\n',
        seeds=[4, 5],
        fingerprint="00ff",
        wall_s=0.5,
        checks=True,
        interrupted=False,
    )
    assert json.loads(json.dumps(said)) == said
    assert said["innervate"] == innervate.__version__
    assert (said["seeds"], said["fingerprint"], said["wall_s"]) == ([4, 5], "00ff", 0.5)
    assert len(said["scenario_sha256"]) == 64
    assert said["packages"]["numpy"]


def test_outside_a_checkout(tmp_path):
    assert checkout(tmp_path) == (None, None)
    (tmp_path / ".git").mkdir()
    assert checkout(tmp_path) == (None, None)


def test_a_git_that_hangs_is_not_waited_for(tmp_path, monkeypatch):
    (tmp_path / ".git").mkdir()
    slow = tmp_path / "bin" / "git"
    slow.parent.mkdir()
    slow.write_text("#!/bin/sh\nexec sleep 60\n")
    slow.chmod(0o755)
    monkeypatch.setenv("PATH", str(slow.parent), prepend=os.pathsep)
    monkeypatch.setattr(provenance_module, "GIT_TIMEOUT_S", 0.2)
    begun = wall_s()
    assert checkout(tmp_path) == (None, None)
    assert wall_s() - begun < 30


def test_in_a_checkout(tmp_path):
    git(tmp_path, "init")
    (tmp_path / "a").write_text("1")
    git(tmp_path, "add", "a")
    git(tmp_path, "commit", "-m", "first")
    git(tmp_path, "tag", "v1.0-rc")
    commit, modified = checkout(tmp_path)
    assert commit is not None
    assert len(commit) == 40
    assert modified is False
    (tmp_path / "a").write_text("2")
    assert checkout(tmp_path) == (commit, True)


def test_the_checkout_that_it_runs_from_is_its_own():
    root = Path(__file__).resolve().parents[2]
    assert checkout() == checkout(root)
    assert (checkout()[0] is not None) == (root / ".git").exists()


def test_it_says_what_it_was_told_and_hashes_the_scenario():
    text = 'kind = "mesh"\n'
    told = {"seeds": [1], "fingerprint": "f", "wall_s": 2.5}
    said = provenance(scenario_toml=text, checks=False, interrupted=True, **told)
    assert said["scenario_sha256"] == hashlib.sha256(text.encode()).hexdigest()
    assert (said["checks"], said["interrupted"], said["schema"]) == (False, True, 1)
    assert said["python"] == platform.python_version()
    assert (said["commit"], said["modified"]) == checkout()


def test_a_package_that_is_missing_has_no_version(monkeypatch):
    monkeypatch.setattr("innervate.trace.provenance.PACKAGES", ("numpy", "no-such-package"))
    said = provenance(scenario_toml="", seeds=[], fingerprint="", wall_s=0, checks=True,
                      interrupted=False)  # fmt: skip
    assert said["packages"]["no-such-package"] is None
    assert said["packages"]["numpy"]
