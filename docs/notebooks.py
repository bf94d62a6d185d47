"""Makes the notebooks of examples/notebooks: `python -m docs.notebooks` runs each and keeps it.

Each is a plain script with cells (`# %%`) that can be run as one, too; the notebook beside it has
the same cells and what they gave. A test holds them together.
"""

from __future__ import annotations

import re
import sys
import tempfile
from pathlib import Path
from typing import Any

import nbformat
from nbclient import NotebookClient

FOLDER = Path(__file__).resolve().parent.parent / "examples" / "notebooks"
CELL = re.compile(r"^# %%(?P<prose> \[markdown\])?\n", re.MULTILINE)
KERNEL = {"kernelspec": {"name": "python3", "display_name": "Python 3", "language": "python"}}


def scripts() -> list[Path]:
    """The scripts, by name."""
    return sorted(FOLDER.glob("*.py"))


def cells(text: str) -> list[tuple[bool, str]]:
    """(prose, text) of a script's cells."""
    _, *parts = CELL.split(text)
    return [
        (
            bool(prose),
            re.sub(r"^# ?", "", body.strip(), flags=re.MULTILINE) if prose else body.strip(),
        )
        for prose, body in zip(parts[::2], parts[1::2], strict=True)
    ]


def notebook(script: Path) -> Any:
    """A script as a notebook that has not been run."""
    made = nbformat.v4.new_notebook(metadata=KERNEL)
    for number, (prose, body) in enumerate(cells(script.read_text(encoding="utf-8"))):
        new = nbformat.v4.new_markdown_cell if prose else nbformat.v4.new_code_cell
        made.cells.append(new(body, id=f"{script.stem}-{number}"))
    return made


def executed(script: Path, folder: Path, kernel: Any = None) -> Any:
    """The notebook of a script with what its cells give, run in a folder.

    Args:
        script: of examples/notebooks.
        folder: what it writes goes there.
        kernel: a manager of a kernel that is up, and forgets first what it knows; None = its own.
    """
    made = notebook(script)
    if kernel is not None:
        forget = f"%reset -f\nimport os\nos.chdir({str(folder)!r})\ndel os"
        made.cells.insert(0, nbformat.v4.new_code_cell(forget))
    run_all(made, kernel, resources={"metadata": {"path": str(folder)}}, coalesce_streams=True)
    if kernel is not None:
        del made.cells[0]
    for cell in made.cells:  # neither times nor what was there only while it ran
        cell.metadata.clear()
        if cell.cell_type == "code":
            cell.outputs = [one for one in cell.outputs if not is_passing(one)]
    made.metadata = nbformat.from_dict(KERNEL)
    return made


def run_all(made: Any, kernel: Any = None, **options: Any) -> None:
    """Run all cells of a notebook, which keeps what they give; options are `NotebookClient`'s."""
    client = NotebookClient(made, km=kernel, timeout=300, **options)
    try:
        client.execute()
    finally:
        if client.kc is not None:  # of a kernel that goes on: its heartbeat would go on, too,
            client.kc.stop_channels()  # and break off the process once the kernel is shut down


def is_passing(output: Any) -> bool:
    """True of a bar that is gone, and of what is said of progress."""
    gone = output.output_type == "display_data" and not any(output.data.values())
    return gone or (output.output_type == "stream" and output.name == "stderr")


def main(names: list[str]) -> None:
    """Run and write the notebooks of these names, or all."""
    for script in scripts():
        if not names or script.stem in names:
            with tempfile.TemporaryDirectory() as folder:
                nbformat.write(executed(script, Path(folder)), script.with_suffix(".ipynb"))
            print(f"Written: {script.with_suffix('.ipynb').name}")


if __name__ == "__main__":
    main(sys.argv[1:])
