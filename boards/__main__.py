"""Makes the folder that a maker copies to a board.

`python -m boards [FOLDER] [name=value ...]`: a cell of the skin, into build/board if no folder is
given; names are parameters of the protocol (see docs/skin.md), which all cells must share.
"""

from __future__ import annotations

import shutil
import sys
from pathlib import Path

from boards import join, records
from boards.compile import mpy
from boards.errors import BoardMissing
from boards.roles import ROLES
from innervate.live.errors import LiveError
from innervate.networks.skin.live.parameters import skin_parameters

HERE = Path(__file__).resolve().parent / "micropython"
ROOM = Path(__file__).resolve().parent.parent / "src"
SHARED = (
    "networks/skin/protocol/constants", "networks/skin/frames",
    "wire/bits", "wire/crc", "wire/layout", "wire/cobs",
)  # fmt: skip


def cell_files(params: dict[str, int]) -> dict[str, bytes]:
    """Path and content of everything that a cell needs; main.py stays readable."""
    role = ROLES["skin"]
    sources = {
        "node": join.fixed(join.joined(role.entry), params),
        "records": records.module_source(
            params, State=role.state, Params=role.params, Frame=role.frame
        ),
        **{name: (HERE / f"{name}.py").read_text() for name in ("outbox", "cell")},
        **{f"innervate/{name}": (ROOM / f"innervate/{name}.py").read_text() for name in SHARED},
    }
    made = {f"{name}.mpy": mpy(text, name.rpartition("/")[2]) for name, text in sources.items()}
    return {**made, "main.py": (HERE / "main.py").read_bytes()}


def numbers_of(arguments: list[str]) -> dict[str, int]:
    """`name=value` as parameters.

    Raises:
        LiveError: not of this form, no such parameter, or out of its range.
    """
    changes = {}
    for argument in arguments:
        name, _, value = argument.partition("=")
        if not value.lstrip("-").isdigit():
            raise LiveError(f"{argument}: give a whole number, like beacon_us=20000")
        changes[name] = int(value)
    return skin_parameters(changes, "boards")


def main(arguments: list[str]) -> int:
    """The command; its exit code."""
    folders = [argument for argument in arguments if "=" not in argument]
    if len(folders) > 1:
        print(f"{folders[1]}: one folder is enough", file=sys.stderr)
        return 2
    folder = Path(folders[0] if folders else "build/board")
    try:
        files = cell_files(numbers_of([a for a in arguments if "=" in a]))
    except (LiveError, BoardMissing) as error:
        print(error, file=sys.stderr)
        return 2
    if folder.exists() and not (folder / "cell.mpy").exists() and any(folder.iterdir()):
        print(f"{folder}: not empty and not made by this command; name another", file=sys.stderr)
        return 2
    shutil.rmtree(folder, ignore_errors=True)
    for name, content in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(content)
    print(f"{folder}: {len(files)} files, {sum(map(len, files.values()))} bytes")
    print(f"copy it: mpremote cp -r {folder}/. : + reset")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
