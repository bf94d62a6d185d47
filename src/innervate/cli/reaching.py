"""Runs a folder's tests and notes which functions of some files they call.

`python -m innervate.cli.reaching OUT FOLDER FILE ...`: a process of its own, as tests may do
anything. Writes {"code", "reached", "unreached": [[name, file, line], ...]} to OUT.
"""

from __future__ import annotations

import ast
import json
import sys
from pathlib import Path
from types import FrameType
from typing import Any


def main(out: str, folder: str, *files: str) -> int:
    """The exit code of the tests."""
    try:
        import pytest
    except ModuleNotFoundError:
        print("pytest is not there; install it with: pip install pytest", file=sys.stderr)
        return 2
    called: set[tuple[str, str]] = set()
    wanted = set(files)

    def note(frame: FrameType, _event: str, _given: Any) -> None:
        code = frame.f_code
        if code.co_filename in wanted:
            called.add((code.co_filename, code.co_name))

    sys.settrace(note)  # no lines are traced, and nothing that is written in C
    code = int(pytest.main([folder, "-q", "-p", "no:cacheprovider", "--rootdir", folder]))
    sys.settrace(None)
    every = [
        (node.name, path, node.lineno)
        for path in files
        for node in ast.parse(Path(path).read_text(encoding="utf-8")).body
        if isinstance(node, ast.FunctionDef)
    ]
    left = [one for one in every if (one[1], one[0]) not in called]
    told = {"code": code, "reached": len(every) - len(left), "unreached": left}
    Path(out).write_text(json.dumps(told), encoding="utf-8")
    return code


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
