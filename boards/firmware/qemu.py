"""The same calls on emulated processors: a hash over all of them, compared with this machine's."""

from __future__ import annotations

import re
import subprocess
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from boards.errors import BoardFailed, BoardMissing
from boards.firmware.marks import fold_in_c
from boards.firmware.native import run, write
from boards.firmware.script import KEPT_MOST, WHAT
from innervate.firmware.emit import Library
from innervate.firmware.tools import find

HERE = Path(__file__).resolve().parent
TICK_INSTRUCTIONS = 40  # of the board's timer at 25 MHz, where an instruction counts as 1 ns


class Target(NamedTuple):
    """An emulated processor."""

    compiler: str
    options: tuple[str, ...]
    emulator: tuple[str, ...]
    origin: str
    stack: str


CORTEX = ("qemu-system-arm", "-M", "mps2-an385")
RISCV = ("qemu-system-riscv32", "-M", "virt", "-bios", "none")
TARGETS = {
    "cortex-m0": Target("arm-none-eabi-gcc", ("-mcpu=cortex-m0", "-mthumb"), CORTEX,
                        "0x00000000", "0x20400000"),
    "cortex-m3": Target("arm-none-eabi-gcc", ("-mcpu=cortex-m3", "-mthumb"), CORTEX,
                        "0x00000000", "0x20400000"),
    "risc-v": Target("riscv64-unknown-elf-gcc", ("-march=rv32imac", "-mabi=ilp32",
                     "--specs=picolibc.specs"), RISCV, "0x80000000", "0x80800000"),
}  # fmt: skip


class Result(NamedTuple):
    """What a script gave: hashes, and by handler how many calls and ticks."""

    marks: list[int]
    calls: dict[str, int]
    ticks: dict[str, int]


def _compile(
    library: Library, folder: Path, command: list[str | Path], beside: str, made: Path
) -> None:
    source = write(library, folder)
    text = (HERE / "check.c").read_text().replace("FOLD_FRAME", fold_in_c(library.role))
    text = re.sub(r"\brole(?=[_.])", library.prefix, text)
    text = re.sub(r"\bROLE(?=_)", library.prefix.upper(), text)
    (folder / "check.c").write_text(text)
    flags = [flag for flag, there in (
        ("-DHAS_FRAME", "frame" in library.records), ("-DHAS_GATE", "gate" in library.records),
        ("-DHAS_CARRIER", any(m.name == "on_carrier" for m in library.program.handlers)),
    ) if there]  # fmt: skip
    flags += [f"-DKEPT_{what.upper()}={count}" for what, count in KEPT_MOST.items()]
    run([*command, *flags, f"-DTIMERS={max(1, library.role.timers)}", "-I", folder, source,
         folder / "check.c", HERE / beside, "-o", made, "-lgcc"])  # fmt: skip


def _result(said: str) -> Result:
    numbers = [int(word, 16) for word in said.split()]
    counts = numbers[-2 * len(WHAT) :]
    if len(counts) != 2 * len(WHAT):
        raise BoardFailed(f"the check said {said[:200]!r}")
    calls = dict(zip(WHAT, counts[::2], strict=True))
    return Result(numbers[: -len(counts)], calls, dict(zip(WHAT, counts[1::2], strict=True)))


def on_host(library: Library, folder: Path, script: Path, checks: Sequence[str] = ()) -> Result:
    """Play a script here; `checks` are options of the compiler.

    Raises:
        BoardMissing, BoardFailed: no compiler, or it does not get through.
    """
    made = folder / "check"
    _compile(library, folder, ["gcc", "-std=c99", "-O1", *checks], "host.c", made)
    with script.open("rb") as file:
        done = subprocess.run([made], stdin=file, capture_output=True, text=True, check=True)
    return _result(done.stdout)


def bare(target: Target, ld: Path) -> list[str | Path]:
    """How a bare image for a target is compiled; its linker script is written to a path."""
    text = (HERE / "target.ld").read_text()
    ld.write_text(text.replace("ORIGIN_", target.origin).replace("STACK_", target.stack))
    return [target.compiler, *target.options, "-std=gnu99", "-Os", "-ffreestanding", "-nostdlib",
            "-nostartfiles", "-T", ld, "-Wl,--no-warn-rwx-segments"]  # fmt: skip


def played(target: Target, image: Path, folder: Path, counted: bool) -> str:
    """What an image says, with a folder's files at hand; `counted`: see `on_target`."""
    words = [*target.emulator, "-display", "none", "-monitor", "none", "-serial", "none",
             "-kernel", str(image), "-semihosting-config", "enable=on,target=native"]  # fmt: skip
    if counted:
        words += ["-icount", "shift=0"]
    done = subprocess.run(words, cwd=folder, capture_output=True, text=True, check=False)
    return done.stderr or done.stdout


def on_target(
    library: Library, folder: Path, script: Path, name: str, counted: bool = False
) -> Result:
    """Play a script on an emulated processor; `counted`: an instruction takes a nanosecond.

    Raises:
        BoardMissing, BoardFailed: something is not installed, or it does not get through.
    """
    target = TARGETS[name]
    for tool in (target.compiler, target.emulator[0]):
        try:
            find(tool)
        except Exception as missing:
            raise BoardMissing(str(missing)) from missing
    made = folder / f"{name}.elf"
    _compile(library, folder, bare(target, folder / f"{name}.ld"), "target.c", made)
    assert script.name == "script"
    return _result(played(target, made, script.parent, counted))
