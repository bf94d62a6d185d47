"""`innervate scenarios`, `new` and `check`: scenario files, without a simulation."""

from __future__ import annotations

from pathlib import Path

from innervate import scenario
from innervate.cli.errors import UserError


def scenarios() -> int:
    """List the bundled scenarios, a line each: what the file's first comment says."""
    files = scenario.bundled()
    width = max(len(name) for name in files)
    for name, path in files.items():
        print(f"{name:<{width}}  {_first_comment(path)}")
    return 0


def _first_comment(path: Path) -> str:
    with path.open(encoding="utf-8") as file:
        line = file.readline().strip()
    return line.lstrip("# ") if line.startswith("#") else ""


def new(kind: str, file: Path | None) -> int:
    """Write a commented scenario; never over a file that is there."""
    text = scenario.template(kind)
    if file is None:
        print(text, end="")
        return 0
    try:
        with file.open("x", encoding="utf-8") as target:
            target.write(text)
    except FileExistsError:
        raise UserError(f"{file} is there already; choose another name or move it away") from None
    except OSError as error:
        raise UserError(f"{file} cannot be written: {error.strerror}") from None
    print(f"Written: {file}. Check it with `innervate check {file}`, run it with "
          f"`innervate run {file}`.")  # fmt: skip
    return 0


def check(file: str, sets: list[str], seed: int | None) -> int:
    """Say what a scenario holds."""
    print(scenario.check(file, sets, seed))
    return 0
