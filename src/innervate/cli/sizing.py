"""`innervate size`."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

from innervate.cli import errors
from innervate.cli.live_table import LiveTable

if TYPE_CHECKING:
    from innervate.sweeping.sizing import Answer


def size(question: dict[str, Any], how: dict[str, Any]) -> int:
    """Answer how many interface ports a robot's skin needs, with a table and a picture."""
    from innervate.sweeping import sizing

    ports = sizing.parse_ports(question.pop("ports"))
    asked = sizing.Question(ports=ports, **question)
    folder = how.pop("out") or Path("sweeps") / f"size-{Path(asked.urdf).stem}"
    with LiveTable(folder.name, (sizing.RECOVERY, "data.loss_ratio")) as table:
        try:
            answer = sizing.size(asked, out=folder, progress=table, **how)
        except KeyboardInterrupt:
            table.close()
            errors.say(f"interrupted; {table.words}; they are kept in {folder}, and the same "
                       "command goes on from there")  # fmt: skip
            return errors.INTERRUPTED
    for line in sizing.answer_lines(answer):
        print(line)
    print(f"Drawn: {draw(answer, folder)}")
    return 0


def draw(answer: Answer, folder: Path) -> Path:
    """The picture in the sweep's folder, with the ports that the hardest rate needs."""
    from innervate import scenario as scenarios
    from innervate.plot import sizing as figure
    from innervate.plot import style
    from innervate.plot.words import number_of

    asked = answer.question
    ports = max(n or max(asked.ports) for n in answer.needed.values())
    base = answer.sweep.plan.base
    graph = scenarios.plan(base.scenario([("body.interfaces", ports)])).graph
    columns = answer.table.to_dict(as_series=False)
    limits = (asked.loss_max, asked.recovery_ms_max)
    with style.house():
        made = figure.draw(
            columns, graph, limits, f"{graph.cells} cells, {number_of(ports, 'port')}"
        )
        return style.save(made, folder, "size")[0]
