"""What `mkdocs.yml` cannot say: pages that lie outside docs/, and the list of decisions.

A hook of MkDocs; `make docs` runs it.
"""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

from mkdocs.structure.files import File

ROOT = Path(__file__).resolve().parent.parent
# Files elsewhere, by what they are called on the site.
PAGES = {
    "architecture.md": "ARCHITECTURE.md",
    "changes.md": "CHANGELOG.md",
    "boards/micropython/README.md": "boards/micropython/README.md",
}


def on_config(config: Any) -> Any:
    """A folder in the navigation stands for its pages, in order."""
    for section in config.nav:
        if isinstance(section, dict):
            for entries in section.values():
                for entry in entries:
                    _spread(entry, Path(config.docs_dir))
    return config


def _spread(entry: Any, docs: Path) -> None:
    for title, where in entry.items() if isinstance(entry, dict) else ():
        if where.endswith("/"):
            entry[title] = [
                path.relative_to(docs).as_posix() for path in sorted((docs / where).glob("*.md"))
            ]


def on_files(files: Any, config: Any) -> Any:
    """Pages from elsewhere in the repository, and the examples to download."""
    made = {name: (ROOT / where).read_text(encoding="utf-8") for name, where in PAGES.items()}
    examples = sorted(path for path in (ROOT / "examples").iterdir() if path.is_file())
    for path in examples:
        made[f"examples/{path.name}"] = path.read_text(encoding="utf-8")
    listed = "".join(f"- [{path.name}]({path.name}): {about(path)}\n" for path in examples)
    made["examples/index.md"] = f"# Examples\n\n{listed}"
    for path in sorted((ROOT / "examples" / "notebooks").glob("*.ipynb")):
        text = path.read_text(encoding="utf-8")
        made[f"notebooks/{path.name}"] = text
        made[f"notebooks/{path.stem}.md"] = notebook_page(path.name, json.loads(text)["cells"])
    for name, text in made.items():
        files.append(File.generated(config, name, content=text))
    return files


def about(example: Path) -> str:
    """The first sentence of an example, which says what it shows."""
    begun = example.read_text(encoding="utf-8").removeprefix('"""').removeprefix("# ")
    words = " ".join(begun.partition("\n\n")[0].replace("\n# ", "\n").split())
    return re.split(r"(?<=[.?]) ", words)[0]


def notebook_page(name: str, cells: list[Any]) -> str:
    """A notebook as a page: its cells and what they gave."""
    parts = []
    for cell in cells:
        text = "".join(cell["source"])
        parts.append(text if cell["cell_type"] == "markdown" else f"```python\n{text}\n```")
        parts += [_shown(output) for output in cell.get("outputs", ())]
    title, *rest = parts
    return "\n\n".join([title, f"[{name}]({name}) is this page to run.", *rest])


def _shown(output: Any) -> str:
    """What a cell gave: a picture, HTML as it stands, or text."""
    data = output.get("data", {})
    if "image/png" in data:
        return f'<img alt="a figure" src="data:image/png;base64,{data["image/png"].strip()}">'
    if "text/html" in data:
        lines = "".join(data["text/html"]).splitlines()
        return f'<div style="overflow-x:auto">{"".join(lines)}</div>'
    text = "".join(output.get("text", data.get("text/plain", "")))
    return f"```text\n{text.rstrip()}\n```"


def on_page_markdown(markdown: str, page: Any, **_: Any) -> str:
    """Links into and out of docs/ lead to where the pages are on the site."""
    if page.file.src_uri in ("architecture.md", "changes.md"):
        markdown = markdown.replace("](docs/", "](")
    return (
        markdown.replace("](../../docs/", "](../../")
        .replace("](../boards/", "](boards/")
        .replace("](../examples)", "](examples/index.md)")
        .replace("](../examples/notebooks/", "](notebooks/")
        .replace("](../examples/", "](examples/")
    )
