"""What C of the protocols takes on a microcontroller: `python -m boards.firmware.measure`.

Prints the tables of docs/firmware.md, in Markdown: flash, RAM and worst stack as arm-none-eabi-gcc
makes and counts them with -Os for a Cortex-M0; instructions per handler as an emulated Cortex-M3
takes them in replayed and drawn calls (QEMU's clock: a nanosecond an instruction).
"""

from __future__ import annotations

import re
import subprocess
import tempfile
from pathlib import Path

from boards.firmware import qemu
from boards.firmware.__main__ import emulate
from boards.firmware.native import run
from boards.firmware.native import write as write_bare
from boards.firmware.script import WHAT
from boards.firmware.stack import COUNTED, chain, worst
from boards.roles import roles
from innervate.firmware import library, tools
from innervate.firmware.records import layout

CALLS = 20_000
LOOP_HZ = 250
# Whole images: the example, and how many UARTs it has, each with how many bytes that wait.
WHOLE = {"skin": ("small", 4, 16), "radio": ("modem", 2, 64), "mesh": ("small", 2, 64)}
SEALED = {f"sealed {name}": WHOLE[name] for name in ("skin", "mesh")}
LEADING = "leading "  # a gateway, or a standby
OF_MESH = {f"{LEADING}mesh": WHOLE["mesh"]}
IMAGES = WHOLE | OF_MESH | SEALED


def sizes(path: Path) -> tuple[int, int, int]:
    """Text, data and bss of an object or image."""
    said = subprocess.run(["arm-none-eabi-size", path], capture_output=True, text=True, check=True)
    text, data, bss = map(int, said.stdout.splitlines()[1].split()[:3])
    return text, data, bss


def protocol_row(name: str, folder: Path) -> str:
    """A row of the table of protocols alone."""
    made = library.made_of(name, []).library
    source = write_bare(made, folder)
    done = folder / f"{name}.o"
    tools.run("arm-none-eabi-gcc", *tools.CORTEX_M0, *tools.SMALL, "-I", folder,
              COUNTED, "-c", source, "-o", done)  # fmt: skip
    flash = sizes(done)[0]
    state, gate = (layout(made.records[record])[1] if record in made.records else 0
                   for record in ("state", "gate"))  # fmt: skip
    outbox = int(re.findall(r"(\d+)", _size_of(made.prefix, folder))[0])
    stack = chain(done.with_suffix(".ci").read_text(), f"{made.prefix}_on_")
    lead = f" (+ {gate:,} of one that leads)" if gate else ""
    return f"| {name} | {flash:,} | {state:,}{lead} | {outbox:,} | {stack:,} |"


def _size_of(prefix: str, folder: Path) -> str:
    """Sizeof an outbox, as the compiler says it in an error."""
    (folder / "size.c").write_text(
        f'#include "{prefix}.h"\nchar (*x)[sizeof({prefix}_out_t)] = 1;\n'
    )
    command = ["arm-none-eabi-gcc", *tools.CORTEX_M0, "-I", str(folder), "-fsyntax-only",
               str(folder / "size.c")]  # fmt: skip
    said = subprocess.run(command, capture_output=True, text=True, check=False).stderr
    return re.findall(r"char \(\*\)\[(\d+)\]", said)[0]


def whole(name: str, folder: Path, out: Path) -> tuple[int, int, int]:
    """Flash, static RAM and worst stack of the image of a whole node; its library lies there."""
    main, uarts, ring = IMAGES[name]
    options = [*tools.CORTEX_M0, f"-DBOARD_UARTS={uarts}", f"-DBOARD_RING={ring}", COUNTED,
               "-DKEY=1", *(["-DLEADS"] if name.startswith(LEADING) else [])]  # fmt: skip
    image = tools.image(folder, name.split()[-1], out, main, options)
    text, data, bss = sizes(image)
    return text + data, data + bss, worst(image)


def whole_row(name: str) -> str:
    """A row for the image of a whole node."""
    with tempfile.TemporaryDirectory() as made:
        folder = Path(made)
        library.write(library.made_of(name.split()[-1], [], sealed=name in SEALED), folder)
        flash, ram, stack = whole(name, folder, folder)
    what = f"{IMAGES[name][1]} UARTs, coder, driver, port layer, vectors"
    return f"| {name}, {what} | {flash:,} | {ram:,} | {stack:,} | {ram + stack:,} |"


def handshake() -> list[int]:
    """Instructions of a question, its answer, what the answer takes, a frame closed and opened."""
    with tempfile.TemporaryDirectory() as made:
        folder, target = Path(made), qemu.TARGETS["cortex-m3"]
        library.write(library.made_of("skin", [], sealed=True), folder)
        sources = [*folder.glob("innervate_*.c"), *folder.glob("crypto/*.c"),
                   qemu.HERE / "handshake.c", qemu.HERE / "target.c"]  # fmt: skip
        image = folder / "handshake.elf"
        compiled = qemu.bare(target, folder / "handshake.ld")
        run([*compiled, "-I", folder, *sources, "-lgcc", "-o", image])
        said = qemu.played(target, image, folder, counted=True).split()
    assert said[-1] == "ok", said
    return [int(word, 16) * qemu.TICK_INSTRUCTIONS for word in said[:-1]]


def instructions(name: str) -> str:
    """A row of the table of instructions."""
    found = emulate(roles()[name], CALLS, 1, counted=True)["cortex-m3"]
    per = {what: found.ticks[what] * qemu.TICK_INSTRUCTIONS / count
           for what, count in found.calls.items() if count}  # fmt: skip
    cells = [f"{per[what]:,.0f}" if what in per else "" for what in WHAT]
    return f"| {name} | {' | '.join(cells)} |"


def main() -> None:
    """Print all tables."""
    names = ["skin", "radio", "csma", "mesh"]
    print("| protocol | flash | state | outbox | worst stack |\n|---|---:|---:|---:|---:|")
    with tempfile.TemporaryDirectory() as folder:
        for name in names:
            print(protocol_row(name, Path(folder)), flush=True)
    print("\n| image | flash | static RAM | worst stack | RAM |\n|---|---:|---:|---:|---:|")
    for name in IMAGES:
        print(whole_row(name), flush=True)
    print(f"\n| protocol | {' | '.join(f'`{what}`' for what in WHAT)} |")
    print("|---|" + "---:|" * len(WHAT))
    for name in names:
        print(instructions(name), flush=True)
    print("\n| to ask | to answer | to take the answer | a frame closed | opened |")
    print("|" + "---:|" * 5)
    print(f"| {' | '.join(f'{count:,}' for count in handshake())} |")


if __name__ == "__main__":
    main()
