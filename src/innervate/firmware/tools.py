"""Compilers and emulators: where they are, and what they say."""

import shutil
import subprocess
from collections.abc import Sequence
from pathlib import Path

from innervate.firmware.errors import FirmwareError

# Debian's packages of what is asked for.
PACKAGES = {
    "cc": "gcc libc6-dev",
    "arm-none-eabi-gcc": "gcc-arm-none-eabi libnewlib-arm-none-eabi",
    "riscv64-unknown-elf-gcc": "gcc-riscv64-unknown-elf picolibc-riscv64-unknown-elf",
    "qemu-system-arm": "qemu-system-arm",
    "qemu-system-riscv32": "qemu-system-misc",
}


def find(name: str) -> str:
    """Where a tool is.

    Raises:
        FirmwareError: nowhere; what to install.
    """
    found = shutil.which(name)
    if found is None:
        package = PACKAGES.get(name, name)
        raise FirmwareError(
            f"{name} is missing; install it (Debian, Ubuntu: apt install {package})"
        )
    return found


def run(name: str, *words: str | Path) -> str:
    """What a tool prints.

    Raises:
        FirmwareError: it is not there, or does not get through; its first line.
    """
    command = [find(name), *map(str, words)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        said = (done.stderr or done.stdout).strip().splitlines() or [f"exit code {done.returncode}"]
        line = next((one for one in said if "error" in one), said[0])
        raise FirmwareError(f"{name}: {line}")
    return done.stdout


CORTEX_M0 = ("-mcpu=cortex-m0", "-mthumb")
CORTEX_M3 = ("-mcpu=cortex-m3", "-mthumb")
SMALL = ("-std=c99", "-Os", "-ffunction-sections", "-fdata-sections", "-ffreestanding")


def sources(folder: Path, prefix: str, main: str) -> list[Path]:
    """What an image is made from; `main` is one of the examples."""
    board = [folder / f"bare/{name}.c" for name in ("start", "board_mps2", f"{prefix}_{main}")]
    return [*sorted(folder.glob("*.c")), *sorted(folder.glob("crypto/*.c")), *board]


def image(
    folder: Path, prefix: str, out: Path, main: str = "main", options: Sequence[str] = CORTEX_M3
) -> Path:
    """Compile a library and an example for a bare board; the image.

    Args:
        folder: where the library was written.
        prefix: of its names.
        out: folder for the image.
        main: "main", which can be looked into, or "small".
        options: of the compiler: which processor; what is said here counts.

    Raises:
        FirmwareError: there is no compiler, or it does not take it.
    """
    made = out / f"{prefix}_{main}.elf"
    run("arm-none-eabi-gcc", *SMALL, *options, "-I", folder, *sources(folder, prefix, main),
        "-nostdlib", "-nostartfiles", "-Wl,--gc-sections", "-T", folder / "bare/link.ld", "-lgcc",
        "-o", made)  # fmt: skip
    return made
