"""What the command says, kept word for word: sessions in a shell, with exit codes.

`python -m tests.recorded.commands` plays the sessions of `commands/*.session` in this process, each
in an empty folder, and writes all that was said beside them, as `*.txt`. A session has one command
a line, and files between `cat > NAME <<END` and `END`. What depends on machine and version stands
there as `-`.
"""

from __future__ import annotations

import contextlib
import io
import json
import os
import re
import shlex
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import innervate
from innervate.cli import live_table, progress
from innervate.cli import main as command
from innervate.live import status
from innervate.live.errors import LiveError
from tests.recorded.record import differences

FOLDER = Path(__file__).resolve().parent / "commands"
NAMES = tuple(sorted(path.stem for path in FOLDER.glob("*.session")))
OF_THE_MACHINE = (
    (f"! {re.escape(progress.COMPILING.format('LOOP')).replace('LOOP', '.*')}\n", ""),
    (r"the bundled ones are .*", "the bundled ones are -"),
    (re.escape(innervate.__version__), "-"),
    (r'"(wall_s|events_per_s|seconds|states_per_s)": [0-9.e+-]+', r'"\1": "-"'),
    (r"simulated in (?:less than )?[0-9.]+ s", "simulated in - s"),
    (r"(points|runs) in [0-9.]+ s\b", r"\1 in - s"),
    (r"(successors|schedules) +[0-9.]+ s ", r"\1  - s "),
    (r"folder /\S+\)", "folder -)"),
    (r"\b[0-9]{4}-[0-9]{2}-[0-9]{2} [0-9]{2}:[0-9]{2}:", "-:"),
)


def sessions(name: str) -> Iterator[tuple[str, str]]:
    """The commands of a session, and for those that write a file what goes into it."""
    lines = iter((FOLDER / f"{name}.session").read_text(encoding="utf-8").splitlines())
    for line in lines:
        if line.startswith("cat > "):
            text = "".join(f"{more}\n" for more in iter(lines.__next__, "END"))
            yield line.split()[2], text
        elif line and not line.startswith("#"):
            yield line, ""


def said(line: str) -> tuple[int, str, str]:
    """Exit code, standard output and standard error of a command."""
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        code = command(shlex.split(line))
    return code, out.getvalue(), err.getvalue()


@contextlib.contextmanager
def nodes() -> Iterator[None]:
    """Nodes by name, if a file `nodes.json` lies here: what they answer to what they are asked."""
    was = status.ask, status.find, status.sockets, status.ASKED

    def told() -> Any:
        return json.loads(Path("nodes.json").read_text(encoding="utf-8"))

    def ask(path: Path, request: dict[str, Any]) -> Iterator[dict[str, Any]]:
        answers = told()[path.name]
        print(f"asked {path.name}: {json.dumps(request)}", file=sys.stderr)
        if request["do"] not in answers:
            raise LiveError(f"{path.name}: no node answers here")
        yield from answers[request["do"]]

    status.ask, status.find, status.ASKED = ask, Path, 1  # one after the other
    status.sockets = lambda: [Path(name) for name in told()]
    try:
        yield
    finally:
        status.ask, status.find, status.sockets, status.ASKED = was


def masked(text: str, folder: str) -> str:
    """A text without what depends on the machine."""
    text = text.replace(folder, "HERE")
    for pattern, instead in OF_THE_MACHINE:
        text = re.sub(pattern, instead, text)
    return text


def played(name: str, folder: Path) -> str:
    """All that is said in a session that is played in an empty folder."""
    found, was = [], Path.cwd()
    often = progress.LINE_EVERY_S, live_table.LINE_EVERY_S
    progress.LINE_EVERY_S = live_table.LINE_EVERY_S = 1e9
    os.chdir(folder)
    try:
        for line, text in sessions(name):
            if text:
                Path(line).write_text(text, encoding="utf-8")
            elif line.startswith("show "):
                kept = Path(line.split()[1]).read_text(encoding="utf-8")
                found.append(f"$ {line}\n{masked(kept, str(folder))}")
            else:
                with nodes() if Path("nodes.json").exists() else contextlib.nullcontext():
                    code, out, err = said(line)
                marked = "".join(f"! {one}\n" for one in err.splitlines())
                whole = masked(f"{out}{marked}", str(folder))
                found.append(f"$ {line}\n{whole}({code})\n")
    finally:
        progress.LINE_EVERY_S, live_table.LINE_EVERY_S = often
        os.chdir(was)
    return "".join(found)


def by_command(text: str) -> dict[str, Any]:
    """What was said, by command and line."""
    found: dict[str, Any] = {}
    for at, one in enumerate(re.split(r"^\$ ", text, flags=re.MULTILINE)[1:], 1):
        first, *lines = one.splitlines()
        found |= {f"{at} {first} line {i}": line for i, line in enumerate(lines)}
    return found


def changes(name: str, folder: Path) -> list[str]:
    """Where a session says something else than was kept, one line each."""
    kept = (FOLDER / f"{name}.txt").read_text(encoding="utf-8")
    return differences(name, by_command(kept), by_command(played(name, folder)))


def main() -> int:
    """Write what is said, of all sessions or those that are named."""
    for name in sys.argv[1:] or NAMES:
        with tempfile.TemporaryDirectory() as folder:
            text = played(name, Path(folder).resolve())
        (FOLDER / f"{name}.txt").write_text(text, encoding="utf-8")
        print(f"said {name}", flush=True)
    return 0


if __name__ == "__main__":
    sys.exit(main())
