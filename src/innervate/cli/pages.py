"""`innervate docs`: the pages of the documentation, which come with the toolkit."""

import re
import sys
from pathlib import Path

from innervate.cli import errors
from innervate.scenario.explain import nearest

# In a wheel beside this file; in a checkout where they are written.
FOLDERS = (Path(__file__).parent / "pages", Path(__file__).parents[3] / "docs")

NAMED = re.compile(r"^::: \S+\.(\w+)$", re.MULTILINE)  # where the site has a name's signature
COMMANDS = re.compile(r"^::: cyclopts\n(?: +.*\n?)*", re.MULTILINE)  # likewise their arguments


def show(page: str = "", /) -> int:
    """Print a page, or the list of them.

    Args:
        page: Its name, as the list has it.
    """
    there = pages()
    if not page:
        width = max(map(len, there))
        for name, path in there.items():
            print(f"{name:{width}}  {title(path)}")
        print("Read one: innervate docs NAME")
        return 0
    name = page.removeprefix("docs/").removesuffix(".md")
    if name not in there:
        hint = nearest(name, list(there)).replace("it knows", "there are")
        raise errors.UserError(f'there is no page "{name[:60]}"{hint}')
    text = there[name].read_text("utf-8")
    if COMMANDS.search(text):
        text = COMMANDS.sub(lambda _: _of_commands(), text)
    _print(NAMED.sub(r"- `innervate.\1`: `help(innervate.\1)`", text))
    return 0


def _of_commands() -> str:
    """Every command with its arguments, as Markdown."""
    from innervate.cli.app import app

    return f"{app.generate_docs(recursive=True, heading_level=2)}\n"


def pages() -> dict[str, Path]:
    """Every page by its name.

    Raises:
        UserError: none came with this installation.
    """
    for folder in FOLDERS:
        if (folder / "index.md").is_file():
            return {path.stem: path for path in sorted(folder.glob("*.md"))}
    raise errors.UserError("no pages came with this installation; they are in docs/ of the sources")


def title(path: Path) -> str:
    """What a page is called."""
    with path.open(encoding="utf-8") as lines:
        return next(lines).lstrip("# ").strip()


def _print(text: str) -> None:
    """As it is into a file or pipe; laid out, page by page, on a terminal."""
    if sys.stdout is None or not sys.stdout.isatty():
        print(text, end="")
        return
    from rich.console import Console
    from rich.markdown import Markdown

    console = Console()
    with console.pager(styles=True):
        console.print(Markdown(text))
