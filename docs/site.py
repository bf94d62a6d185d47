"""What `mkdocs.yml` cannot say: pages that lie outside docs/, and the list of decisions.

A hook of MkDocs; `make docs` runs it.
"""

from __future__ import annotations

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
    listed = "".join(f"- [{path.name}]({path.name})\n" for path in examples)
    made["examples/index.md"] = f"# Examples\n\n{listed}"
    for name, text in made.items():
        files.append(File.generated(config, name, content=text))
    return files


def on_page_markdown(markdown: str, page: Any, **_: Any) -> str:
    """Links into and out of docs/ lead to where the pages are on the site."""
    if page.file.src_uri in ("architecture.md", "changes.md"):
        markdown = markdown.replace("](docs/", "](")
    return (
        markdown.replace("](../../docs/", "](../../")
        .replace("](../boards/", "](boards/")
        .replace("](../examples)", "](examples/index.md)")
        .replace("](../examples/", "](examples/")
    )
