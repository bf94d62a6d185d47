"""The networks inside and between robots, from one protocol source.

`innervate.run(scenario)` runs a scenario, given as a file, as a dictionary or built in code;
`innervate.sweep(scenario, vary=...)` runs it in many variants, many times. The simulator behind
them is loaded at the first use, so that `import innervate` stays cheap.
"""

from __future__ import annotations

TYPE_CHECKING = False  # `typing` would be the slowest part of this import
if TYPE_CHECKING:
    from typing import Any

    from innervate.run import run as run
    from innervate.sweep import sweep as sweep

__version__ = "0.1.0"
__all__ = ["__version__", "run", "sweep"]


def __getattr__(name: str) -> Any:
    """Load the room `run` or `sweep` when it is first asked for.

    Importing a subpackage sets the attribute of its name, like the module `innervate.run`. That
    module is therefore callable itself (see its end): one name, whichever way it was imported.
    """
    if name in ("run", "sweep"):
        from importlib import import_module

        return import_module(f"innervate.{name}")
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
