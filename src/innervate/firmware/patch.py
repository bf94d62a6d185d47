"""A scenario's nodes as firmware: what each emulated board runs."""

from pathlib import Path
from typing import Any

from innervate.firmware.emit import Library
from innervate.firmware.errors import FirmwareError
from innervate.firmware.library import BARE, Files, files_of, write
from innervate.firmware.tools import find, image
from innervate.live.board import Role, roles_of
from innervate.live.deployment import Deployment
from innervate.network import Network, networks


def images(plan: Any, folder: Path, in_python: list[str]) -> dict[str, Path]:
    """Images by the names of nodes over cables: of all that can be boards, but for `in_python`.

    Raises:
        FirmwareError: there are no such nodes, or a compiler or QEMU is missing.
    """
    network = networks()[plan.kind]
    deployment = network.deployment(plan)
    unknown = [name for name in in_python if name not in deployment.names]
    if unknown:
        raise FirmwareError(f"--in-python {unknown[0]}: there are {', '.join(deployment.names)}")
    role = _role_of(network, deployment)
    find("qemu-system-arm")
    library = Library(role, plan.params)
    files = Files(library, files_of(library, network))
    if BARE[0] not in files.texts:
        raise FirmwareError(f"{plan.kind}: its frames have no coder in C, so there is no driver")
    write(files, folder / "lib")
    made = image(folder / "lib", library.prefix, folder)
    return {
        name: made
        for number, name in enumerate(deployment.names)
        if deployment.is_board(number) and name not in in_python
    }


def _role_of(network: Network, deployment: Deployment) -> Role:
    """What all boards of a network run.

    Raises:
        FirmwareError: its nodes cannot be boards.
    """
    kind, roles = network.name, roles_of(network)
    if not roles or deployment.has_channel or not deployment.links:
        raise FirmwareError(f"{kind}: only nodes over cables run on emulated boards so far")
    if roles[-1].hooks:
        raise FirmwareError(
            f"{kind}: --firmware brings up nodes whose ports are cables; a board of this kind "
            "takes its place among live nodes on serial lines (innervate docs firmware)"
        )
    if network.has("packets"):
        raise FirmwareError(
            f"{kind}: its live nodes have packets of their own, its boards the frames of "
            "`frames`: they would not understand each other; leave --firmware out"
        )
    return roles[-1]
