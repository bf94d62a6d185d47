"""Makes ready loops: `python -m innervate.kernel.readying FOLDER` compiles what is bundled.

A loop is compiled as always, for a processor of ten years ago (`ready.baseline`), and written as an
object file without its wrappers for Python. Each is loaded back and has to give the fingerprint of
the compiled one before it is taken.
"""

import hashlib
import json
import os
import sys
import tempfile
import zlib
from pathlib import Path
from typing import Any

from innervate.kernel import ready
from innervate.kernel.sources import content_hash

# Each with the settings that make its run short; what shares a loop stands here once.
BUNDLED: tuple[tuple[str, tuple[str, ...]], ...] = (
    ("demo", ()),
    ("demo", ("protocol.rule='static'",)),
    ("radio-disaster", ()),
    ("radio-figure-1", ()),
    ("radio-disaster", ("protocol.mac='dcf'",)),
    ("mesh-field", ()),
    ("mesh-team", ()),
    ("mesh-leipzig", ("duration_s=21",)),
    ("babel-patch", ()),
)


def write(folder: Path) -> None:
    """Compile all into a folder, which then fits this system; takes minutes."""
    folder.mkdir(parents=True, exist_ok=True)
    for old in folder.glob("*.o.z"):
        old.unlink()
    loops: dict[str, str] = {}
    names: set[str] = set()
    before = content_hash()
    for scenario, settings in BUNDLED:
        (key, data, digest), known = made(scenario, settings)
        (folder / f"{key}.o.z").write_bytes(data)
        loops[key] = digest
        names |= known
        print(f"{scenario} {' '.join(settings)}: {len(data) / 1024:.0f} KiB", flush=True)
    if content_hash() != before:
        raise RuntimeError("sources were edited while their loops were compiled")
    (folder / ready.ABOUT).write_text(json.dumps(about_of(loops, names), indent=1), "utf-8")


def about_of(loops: dict[str, str], names: set[str]) -> dict[str, Any]:
    """What is said of ready loops: for which sources, system and processor they are made."""
    return {
        "form": ready.FORM,
        "target": ready.target(),
        "features": ready.baseline()[1],
        "sources": content_hash(),
        "names": sorted(names),
        "loops": loops,
    }


def packed(name: str, world: Any, code: bytes) -> tuple[str, bytes, str]:
    """A loop as it is kept: its key, its data, their hash."""
    data = zlib.compress(code, 9)
    return ready.key_of(name, world), data, hashlib.blake2b(data, digest_size=16).hexdigest()


def made(scenario: str, settings: tuple[str, ...]) -> tuple[tuple[str, bytes, str], set[str]]:
    """The loop that a bundled scenario runs on, packed, and its plans' names for it.

    Raises:
        RuntimeError: it asks of the machine what a ready loop may not, or runs otherwise.
    """
    from innervate.network import networks
    from innervate.scenario import load, plan

    wanted = plan(load(scenario, list(settings)))
    network = networks()[wanted.kind]
    running = network.simulation(wanted)
    loop = running._advance
    count = len(list(ready._arrays(running.world)))
    loop.compiled(running.world, 0, 1)
    code = object_code(loop._compiled.compiled)
    running._advance = loop.compiled
    running.finish()
    again = network.simulation(wanted)
    advance = ready.called(ready.address_of(code), count)
    again._advance = lambda world, *rest: advance(list(ready._arrays(world)), *rest)
    again.finish()
    if again.fingerprint != running.fingerprint:
        raise RuntimeError(f"{scenario}: the ready loop runs otherwise than the compiled one")
    names = getattr(running, "loop_names", lambda: {running.name})()
    return packed(loop.name, running.world, code), set(names)


def object_code(jitted: Any) -> bytes:
    """A compiled function as an object file with one name that can be called: `ready.ENTRY`."""
    import llvmlite.binding as llvm
    from numba.core.registry import cpu_target

    *_, compiled = jitted.overloads.values()  # of those of several forms the one made last
    module = llvm.parse_bitcode(compiled.library._final_module.as_bitcode())
    for one in (*module.functions, *module.global_variables):
        if not one.is_declaration:
            one.linkage = "internal"
    entry = module.get_function(compiled.fndesc.llvm_func_name)
    entry.linkage, entry.name = "external", ready.ENTRY
    machine = cpu_target.target_context.codegen()._tm
    passes = llvm.create_new_module_pass_manager()
    passes.add_global_dead_code_eliminate_pass()
    passes.run(module, llvm.create_pass_builder(machine, llvm.create_pipeline_tuning_options(0)))
    asked = {one.name for one in (*module.functions, *module.global_variables)
             if one.is_declaration and not one.name.startswith("llvm.")}  # fmt: skip
    if not asked <= set(ready.ASKED):
        raise RuntimeError(f"a ready loop may not ask for {', '.join(sorted(asked))}")
    names = (one for one in module.functions if one.name != ready.ENTRY and not one.is_declaration)
    for number, one in enumerate(names):
        one.name = f"f{number}"  # what Numba calls them is longer than their code
    found: bytes = machine.emit_object(module)
    return found


def main() -> None:
    """Compile for the least processor, without what is in anybody's cache."""
    processor, _features = ready.baseline()
    os.environ.update(NUMBA_CPU_NAME=processor, NUMBA_CPU_FEATURES="", INNERVATE_READY="0")
    with tempfile.TemporaryDirectory() as cache:
        os.environ["INNERVATE_CACHE"] = cache
        write(Path(sys.argv[1]))


if __name__ == "__main__":
    main()
