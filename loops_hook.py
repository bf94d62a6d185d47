"""What the wheel is built with: the pages of the documentation, and what was compiled for it.

Pages are for `innervate docs`. INNERVATE_LOOPS and INNERVATE_NODES, where they are set, name
folders that `python -m innervate.kernel.readying FOLDER` and `python -m
innervate.firmware.readying FOLDER` have filled; the wheel is then one for this system and
processor, for every Python. Without, it is for any system, and compiles.
"""

import glob
import os
import platform
import sys
import sysconfig

from hatchling.builders.hooks.plugin.interface import BuildHookInterface

# By variable: where what is in its folder goes, and a file that is there.
COMPILED = {
    "INNERVATE_LOOPS": ("innervate/kernel/loops", "about.json"),
    "INNERVATE_NODES": ("innervate/firmware/nodes", "*.so"),
}


class Loops(BuildHookInterface):
    """Puts pages and compiled code into the wheel, and says in its name where that runs."""

    def initialize(self, version, build_data):
        """Before a wheel is built; an editable one has none: its sources are yet to change."""
        if version == "editable":
            return
        for page in glob.glob(os.path.join(self.root, "docs", "*.md")):
            name = os.path.basename(page)
            build_data["force_include"][page] = f"innervate/cli/pages/{name}"
        for variable, (place, wanted) in COMPILED.items():
            folder = os.environ.get(variable)
            if not folder:
                continue
            if not glob.glob(os.path.join(folder, wanted)):
                raise FileNotFoundError(f"{variable}: no {wanted} in {folder}")
            build_data["force_include"][os.path.abspath(folder)] = place
            build_data["pure_python"] = False
            build_data["tag"] = f"py3-none-{_platform()}"


def _platform():
    """Of a C library it asks for `memset`, `memmove`: on Linux any that Numba runs with."""
    if sys.platform == "linux":
        return f"manylinux_2_17_{platform.machine()}"
    return sysconfig.get_platform().replace("-", "_").replace(".", "_")
