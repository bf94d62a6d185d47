"""A wheel in an empty environment: what it brings, what it takes on disk, what runs of it."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")
# | `innervate[sim]` | 495 MB | ...
SAID = dict(re.findall(r"^\| `innervate(\[\w+\])?` \| ([\d,]+) MB \|", README, re.MULTILINE))
DRIFT = 1.1  # other packages grow from release to release
ALONE = {key: value for key, value in os.environ.items()
         if not key.startswith(("INNERVATE", "PYTHON", "VIRTUAL_ENV"))}  # fmt: skip


def test_the_readme_says_what_each_takes():
    assert set(SAID) == {"", "[sim]", "[all]"}


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    """The wheel for any system, from what is in the source archive and nothing else.

    Its loops are another test's (tests/kernel/test_ready.py).
    """
    folder = tmp_path_factory.mktemp("dist")
    build = [sys.executable, "-m", "build", "--no-isolation", "--outdir", folder]
    subprocess.run(build, cwd=ROOT, env=ALONE, check=True)
    (made,) = folder.glob("*.whl")
    assert len(list(folder.glob("*.tar.gz"))) == 1
    return made


class Installed:
    """An environment with the wheel and nothing else."""

    def __init__(self, folder, wheel, extra):
        self.folder = folder
        self.bin = folder / "env" / "bin"
        subprocess.run([sys.executable, "-m", "venv", folder / "env"], check=True)
        before = self.megabytes()
        install = [self.bin / "pip", "install", "-q", "--disable-pip-version-check"]
        subprocess.run([*install, f"{wheel}{extra}"], env=ALONE, check=True)
        self.added = self.megabytes() - before

    def megabytes(self):
        return int(subprocess.check_output(["du", "-sm", self.folder], text=True).split()[0])

    def __call__(self, *words):
        cache = {"INNERVATE_CACHE": str(self.folder / "cache")}
        return subprocess.run([self.bin / "innervate", *words], cwd=self.folder, env=ALONE | cache,
                              capture_output=True, text=True, check=False)  # fmt: skip


@pytest.mark.slow  # `make wheel-check`, which CI runs beside the tests, runs all but the last
@pytest.mark.parametrize("extra", ["", "[sim]", "[all]"])
def test_it_takes_what_the_readme_says_and_runs(wheel, tmp_path, extra):
    env = Installed(tmp_path, wheel, extra)
    assert env.added <= int(SAID[extra].replace(",", "")) * DRIFT
    page = env("docs", "sweeps")
    assert page.stdout == (ROOT / "docs" / "sweeps.md").read_text(encoding="utf-8"), page.stderr
    assert (tmp_path / "env/share/man/man1/innervate.1").is_file()
    checked = env("check", "line")
    assert checked.stdout.startswith("line: a skin scenario"), checked.stderr
    doctor = env("doctor")
    assert doctor.returncode == (0 if extra else 1)
    ran = env("run", "line", *([] if extra == "[all]" else ["--plain"]))
    if extra:
        assert "Every cell has a way to the PC" in ran.stdout, ran.stderr
        assert (tmp_path / "runs/line-1/report.html").is_file()
    else:
        assert ran.returncode == 2
        assert "pip install 'innervate[sim]'" in ran.stderr
    if extra == "[all]":
        assert re.findall(r"missing +(\w+) +[^:\n]*; needs", doctor.stdout) == [
            "sweep", "topohub", "rerun",
        ]  # fmt: skip
