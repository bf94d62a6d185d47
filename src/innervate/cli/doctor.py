"""`innervate doctor`: what is installed, what is missing, what will be slow."""

import json
import os
import platform
import shutil
from importlib import util
from pathlib import Path
from typing import Any

import innervate
from innervate.cli import errors
from innervate.cli.options import Json
from innervate.network import networks
from innervate.trace.provenance import version_of

# What each extra is for; which modules it brings is in errors.EXTRA_OF.
EXTRAS = {
    "sim": "simulate: run, sweep, verify, watch",
    "plot": "papers and Run.plot",
    "web": "watch",
    "live": "live nodes with a key or an identity",
    "sweep": "sweeps on a Dask cluster (not in innervate[all])",
    "export": "export --mcap",
    "prove": "prove, and verify's reductions proved rather than trusted",
    "body": "cells on a robot's description, size",
    "topohub": "published graphs for a mesh (not in innervate[all])",
    "rerun": "export --rerun (large; not in innervate[all])",
}
# Programs by what they are for.
PROGRAMS = {
    "cc": "compiles what `firmware` writes, and live nodes as C (engine)",
    "arm-none-eabi-gcc": "firmware for Cortex-M",
    "qemu-system-arm": "live up --firmware: emulated cells",
    "tshark": "reads what `export --pcapng` writes",
}
SMALL_BYTES = 500_000_000


def doctor(*, as_json: Json = False) -> int:
    """Say how things are; 1 if nothing can be simulated.

    Args:
        as_json: Print it as JSON and nothing else.
    """
    found = look()
    if as_json:
        print(json.dumps(found, indent=2))
    else:
        _tell(found)
    return 0 if found["extras"]["sim"]["missing"] == [] else errors.OURS


def look() -> dict[str, Any]:
    """All that is looked at, as `--json` prints it."""
    extras = {
        name: {"for": what, "missing": [one for one in brought_by(name) if not util.find_spec(one)]}
        for name, what in EXTRAS.items()
    }
    return {
        "innervate": innervate.__version__,
        "python": platform.python_version(),
        "machine": f"{platform.system()} {platform.machine()}",
        "cores": os.cpu_count(),
        "numba": version_of("numba"),
        "extras": extras,
        "programs": {name: shutil.which(name) for name in PROGRAMS},
        "networks": sorted(networks()),
        "cache": _cache() if not extras["sim"]["missing"] else None,
    }


def brought_by(extra: str) -> list[str]:
    """The modules that an extra is installed for."""
    return [module for module, of in errors.EXTRA_OF.items() if of == extra]


def _cache() -> dict[str, Any]:
    """Where compiled loops are kept, with what room, and which are there."""
    from innervate.kernel import cache, compilation, ready

    folder = cache.cache_root()
    kept = folder / compilation.source_hash()
    existing = next(one for one in (folder, *folder.parents) if one.exists())
    return {
        "folder": str(folder),
        "writable": os.access(existing, os.W_OK),
        "free_bytes": shutil.disk_usage(existing).free,
        "compiled": sorted(path.stem for path in kept.glob("*.compiled")),
        "ready": list(ready.about().get("names", ())),
    }


def _tell(found: dict[str, Any]) -> None:
    """The same for people: what is well in a line each, what is not with what to do."""
    versions = f"innervate {found['innervate']}, Python {found['python']}, Numba {found['numba']}"
    print(f"{versions}, {found['machine']}, {found['cores']} cores")
    for name, extra in found["extras"].items():
        state = "missing" if extra["missing"] else "ok"
        said = extra["for"]
        if extra["missing"]:
            said += f"; needs {', '.join(extra['missing'])}: pip install 'innervate[{name}]'"
        print(f"  {state:<8} {name:<8} {said}")
    for name, path in found["programs"].items():
        print(f"  {'ok' if path else 'missing':<8} {name}: {PROGRAMS[name]}")
    if found["cache"] is not None:
        _tell_cache(found["cache"])


def _tell_cache(cache: dict[str, Any]) -> None:
    """Whether runs start at once."""
    folder = Path(cache["folder"])
    if not cache["writable"]:
        print(f"  slow     {folder} cannot be written: every process compiles anew; "
              "set INNERVATE_CACHE")  # fmt: skip
    elif cache["free_bytes"] < SMALL_BYTES:
        print(f"  slow     {folder} has little room left: loops may be compiled anew")
    if cache["ready"]:
        print("  ok       the loops of bundled networks came with the toolkit: nothing to compile")
    if cache["compiled"]:
        print(f"  ok       compiled loops in {folder}: {', '.join(cache['compiled'])}")
    elif not cache["ready"]:
        print(f"  slow     nothing is compiled in {folder} yet: the first run of each kind of "
              "network takes about half a minute")  # fmt: skip
