"""`innervate size`: how many interface ports and which periods a skin needs."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated, Any

from cyclopts import Parameter

from innervate import folders
from innervate.cli import errors
from innervate.cli.live_table import LiveTable
from innervate.cli.options import SizeOptions
from innervate.network import networks


def _check_robot(_kind: Any, robot: Any) -> None:
    """Networks and their scenarios have no robot's body: say so before options are asked for."""
    path = Path(robot)
    if robot in networks() or folders.is_one(path) or path.suffix == ".toml":
        raise errors.UserError(
            "size is of skins: it lays cells on a robot's body, and takes a URDF file, not "
            f"{robot[:60]}; of other networks innervate sweep compares sizes: --vary nodes=4,8"
        )


Robot = Annotated[str, Parameter(validator=_check_robot)]


def size(robot: Robot, /, *, options: Annotated[SizeOptions, Parameter(name="*")]) -> int:
    """Answer how many ports a robot needs, with a table and a picture; 1 if none is enough.

    Args:
        robot: A URDF file, or package:NAME/ROBOT like package:icub-models/iCubGenova02.
        options: What is asked of its skin, and how often it is tried.
    """
    from innervate.sweeping.words import failed_lines

    sizing = next(one.sizing for one in networks().values() if one.has("sizing"))
    question = {
        "urdf": robot, "links": options.links, "rates_hz": tuple(options.rate or [250.0]),
        "pitch_mm": options.pitch, "reach_mm": options.reach, "loss_max": options.loss / 100,
        "recovery_ms_max": options.recovery,
    }  # fmt: skip
    _check(question)
    asked = sizing.Question(ports=sizing.parse_ports(options.ports), **question)
    folder = options.out or Path("sweeps") / f"size-{Path(asked.urdf).stem}"
    seed = 1 if options.seed is None else options.seed
    shown = (sizing.RECOVERY, "data.loss_ratio")
    with LiveTable(folder.name, shown, folder, options.json) as table:
        answer = sizing.size(
            asked, out=folder, workers=options.workers, dask=options.dask, progress=table,
            repeat=options.repeat, seed=seed,
        )  # fmt: skip
    picture = answer.draw(folder)
    if options.json:
        told = answer.record() | {"picture": str(picture)}
        print(json.dumps(told, indent=2, ensure_ascii=False, allow_nan=False))
    else:
        for line in [*answer.lines(), *failed_lines(answer.sweep)]:
            print(line)
        print(f"Drawn: {picture}")
    return int(None in answer.needed.values())


# What options of the command set in scenarios, each with its least and greatest value.
RANGES = {
    "rates_hz": ("--rate", 0.01, 10_000),
    "pitch_mm": ("--pitch", 0.5, 100_000),
    "reach_mm": ("--reach", 0.001, 100_000),
    "loss_max": ("--loss", 0, 1),
    "recovery_ms_max": ("--recovery", 0.001, 1e9),
}


def _check(question: dict[str, Any]) -> None:
    """Say what is wrong by the names of the options, not by those of scenario keys."""
    for key, (option, low, high) in RANGES.items():
        given = question.get(key)
        for value in given if isinstance(given, tuple | list) else (given,):
            if value is not None and not low <= value <= high:
                scale = 100 if key == "loss_max" else 1  # given in per cent
                raise errors.UserError(
                    f"{option} must be {scale * low:g} to {scale * high:g}, not {scale * value:g}"
                )
