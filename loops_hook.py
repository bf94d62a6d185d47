"""What the wheel is built with: the pages of the documentation, and ready loops if there are some.

Pages are for `innervate docs`. Loops are taken from the folder INNERVATE_LOOPS, if it is set.

`python -m innervate.kernel.readying FOLDER` fills that folder; the wheel is then one for this
system and processor, for every Python. Without, it is for any system, and compiles.
"""

import glob
import os
import platform
import sys
import sysconfig

from hatchling.builders.hooks.plugin.interface import BuildHookInterface


class Loops(BuildHookInterface):
    """Puts pages and ready loops into the wheel, and says in its name where these run."""

    def initialize(self, version, build_data):
        """Before a wheel is built; an editable one has none: its sources are yet to change."""
        folder = os.environ.get("INNERVATE_LOOPS")
        if version == "editable":
            return
        for page in glob.glob(os.path.join(self.root, "docs", "*.md")):
            name = os.path.basename(page)
            build_data["force_include"][page] = f"innervate/cli/pages/{name}"
        if not folder:
            return
        if not os.path.isfile(os.path.join(folder, "about.json")):
            raise FileNotFoundError(f"INNERVATE_LOOPS: no ready loops in {folder}")
        build_data["force_include"][os.path.abspath(folder)] = "innervate/kernel/loops"
        build_data["pure_python"] = False
        build_data["tag"] = f"py3-none-{_platform()}"


def _platform():
    """A loop asks for nothing of a C library but `memset`: on Linux any that Numba runs with."""
    if sys.platform == "linux":
        return f"manylinux_2_17_{platform.machine()}"
    return sysconfig.get_platform().replace("-", "_").replace(".", "_")
