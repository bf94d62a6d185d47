"""Runs a folder's tests and notes which functions of some files they call.

`python -m innervate.cli.reaching OUT FOLDER FILE ...`: a process of its own, as tests may do
anything. Writes {"code", "reached", "unreached": [[name, file, line], ...]} to OUT.
"""

import ast
import json
import sys
from pathlib import Path
from types import FrameType
from typing import Any

from innervate import folders
from innervate.network import read


def main(out: str, folder: str, *files: str) -> int:
    """The exit code of the tests."""
    try:
        import pytest
    except ModuleNotFoundError:
        print("pytest is not there; install it with: pip install pytest", file=sys.stderr)
        return 2
    if folders.is_one(Path(folder)):
        _ = read(Path(folder)).protocol  # its loops are bounded, also for tests that call it alone
    every = [
        (node.name, path, node.lineno)
        for path in files
        for node in ast.parse(Path(path).read_text(encoding="utf-8")).body
        if isinstance(node, ast.FunctionDef)
    ]
    missing = {(path, name) for name, path, _line in every}

    def note(frame: FrameType, _event: str, _given: Any) -> None:
        missing.discard((frame.f_code.co_filename, frame.f_code.co_name))
        if not missing:
            sys.settrace(None)

    sys.settrace(note)  # no lines are traced, and nothing that is written in C
    code = int(pytest.main([folder, "-q", "-p", "no:cacheprovider", "--rootdir", folder]))
    sys.settrace(None)
    left = [one for one in every if (one[1], one[0]) in missing]
    told = {"code": code, "reached": len(every) - len(left), "unreached": left}
    Path(out).write_text(json.dumps(told), encoding="utf-8")
    return code


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
