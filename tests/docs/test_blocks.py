"""Every block of the pages is run: page by page, in order, in an empty folder.

`blocks.toml` says what is run in a smaller size, and what is run elsewhere or cannot be. Pages with
a test of their own, which looks at every line that they show, are left to it.
"""

import re
import shlex
import shutil
import tomllib
from contextlib import contextmanager
from pathlib import Path

import cyclopts
import pytest

import innervate
from innervate import Mesh, Skin
from innervate.cli import app as line
from innervate.cli import main
from innervate.network import networks
from tests.docs.test_own_network import carried_out, commands
from tests.live.test_in_code import until
from tests.own import alone

__all__ = ["alone"]

HERE = Path(__file__).parent
ROOT = HERE.parents[1]
GIVEN = tomllib.loads((HERE / "blocks.toml").read_text(encoding="utf-8"))
IN_PYTHON = GIVEN["elsewhere"].pop("python")
OWN_TEST = {"docs/api.md", "docs/tutorial.md", "docs/own-network.md"}
BLOCK = re.compile(r"^```(console|python)\n(.*?)^```", re.DOTALL | re.MULTILINE)
TEXTS = {
    str(path.relative_to(ROOT)): path.read_text(encoding="utf-8")
    for path in (ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md")),
                 ROOT / "boards/micropython/README.md")
}  # fmt: skip
LONG_PROOFS = {
    "skin": {"skin, rule feasible", "skin, rule strict"},  # test_feasible.py
    "mesh": {"mesh, delivery", "mesh, passing on"},  # test_caches.py
}
PAGES = [page for page, text in TEXTS.items() if BLOCK.search(text) and page not in OWN_TEST]


def steps(page):
    """(language, text, lines that it says) of every command and block of Python, in order."""
    for language, text in BLOCK.findall(TEXTS[page]):
        if language == "python":
            yield language, text, []
            continue
        for command, said in commands(text):
            yield language, re.sub(r"\s+# .*", "", command).strip(), said


def told(table, page, command):
    """What blocks.toml says of a command, on this page or anywhere; None = nothing."""
    names = [name for name in GIVEN[table] if is_meant(name, page, command)]
    return GIVEN[table][max(names, key=len)] if names else None


def is_meant(name, page, command):
    """True if a name in blocks.toml is a command's: whole, or its beginning and "..."."""
    for given in (command, f"{page}: {command}"):
        if name == given or (name.endswith(" ...") and given.startswith(name[:-3])):
            return True
    return False


def is_left_out(page, language, text):
    if language == "python":
        return text.splitlines()[0] in IN_PYTHON
    return told("elsewhere", page, text) is not None


def played(page, capfd):
    """Run what is to be run of a page."""
    names = {"__name__": "page", "__file__": page}
    for language, text, said in steps(page):
        if is_left_out(page, language, text):
            continue
        if language == "python":
            for old, new in GIVEN["python"].items():
                text = text.replace(old, new)
            exec(compile(text, page, "exec"), names)
        elif begins := told("begins", page, text):
            assert carried_out(text, capfd).startswith(begins), text
        else:
            carry_out(page, text, said, capfd)
        capfd.readouterr()


def carry_out(page, command, said, capfd):
    """Run a command, smaller where blocks.toml says so; what the page shows of it is said."""
    more = told("words", page, command) or ""
    words = with_words(shlex.split(command), shlex.split(more))
    assert words[0] == "innervate", f"{command}: say in blocks.toml who runs it"
    code = main(words[1:])
    out = "".join(capfd.readouterr())
    assert code == (told("ends", page, command) or 0), (command, code, out)
    for shown in filter(None, said):
        assert shown.rstrip(". ") in out, (command, shown, out)


def with_words(words, more):
    """A command with other options; what can be given once is then not what it was."""
    asked = {what_of(*more[i : i + 2]) for i in range(len(more))} - {""}
    kept, place = [], 0
    while place < len(words):
        if what_of(*words[place : place + 2]) in asked:
            place += 2
        else:
            kept.append(words[place])
            place += 1
    return [*kept, *more]


def what_of(option, value=""):
    """What an option is about: of --vary and --set, which are given for each key, the key's."""
    if not option.startswith("--"):
        return ""
    return f"{option} {value.partition('=')[0]}" if option in ("--vary", "--set") else option


@contextmanager
def nothing(_monkeypatch):
    yield


@contextmanager
def a_skin(_monkeypatch):
    assert main(["new", "skin", "my-skin.toml"]) == 0
    yield


@contextmanager
def a_mistake(_monkeypatch):
    """The scenario that docs/scenarios.md has: its 14th line is wrong."""
    head = "\n".join(f"# {number}" for number in range(11))
    Path("my-skin.toml").write_text(f'{head}\nkind = "skin"\n[protocol]\nbeacon_hertz = 50\n')
    yield


@contextmanager
def live_nodes(monkeypatch):
    """A ring of four mesh nodes and a skin of eight cells, as they run when somebody looks."""
    folder = Path("nodes").absolute()
    monkeypatch.setenv("INNERVATE_RUN", str(folder))
    ring = Mesh(
        node=[Mesh.Node(x_m=5.0 * i, y_m=0.0) for i in range(4)],
        link=[Mesh.Link(a=i, b=(i + 1) % 4) for i in range(4)],
        radio=Mesh.Radio(profile="ip"),
    )
    skin = Skin(
        patch=[Skin.Patch(columns=4, rows=2)],
        interface=[Skin.Interface(row=0, column=0)],
        protocol=Skin.Protocol(beacon_hz=25),
        data=Skin.Data(rate_hz=5),
    )
    with (
        innervate.live_up(ring, folder=folder) as nodes,
        innervate.live_up(skin, folder=Path("cells")) as cells,
    ):
        for path in Path("cells").absolute().glob("*.sock"):  # a folder is for one network
            (folder / path.name).symlink_to(path)
        until(lambda: all(told["table"] for told in nodes.status().values()))
        until(lambda: all(told.get("parent", 0) is not None for told in cells.status().values()))
        yield


@contextmanager
def short_proofs(monkeypatch):
    """Of what is proved the short: tests/networks/*/prove prove the long ones in `make test`."""
    for kind, long in LONG_PROOFS.items():
        room = networks()[kind].prove
        every = room.theories

        def short(network, change=None, every=every, long=long):
            found = every(network, change)
            assert long <= {one.name for one in found}
            return [one for one in found if one.name not in long]

        monkeypatch.setattr(room, "theories", short)
    yield


BEFORE = {
    "docs/prove.md": short_proofs,
    "docs/sweeps.md": a_skin,
    "docs/scenarios.md": a_mistake,
    "docs/live.md": live_nodes,
}


@pytest.mark.parametrize("page", PAGES)
def test_every_block_of_the_page(page, alone, monkeypatch, capfd):
    shutil.copytree(ROOT / "examples", "examples")
    with BEFORE.get(page, nothing)(monkeypatch):
        played(page, capfd)


def test_what_is_left_out_is_on_a_page_and_run_where_it_says():
    there = [(page, text if language == "console" else text.splitlines()[0])
             for page in PAGES for language, text, _ in steps(page)]  # fmt: skip
    for table, names in {**GIVEN, "in Python": IN_PYTHON}.items():
        for name in names if table != "python" else ():
            assert any(is_meant(name, *one) for one in there), (table, name)
    for who in [*GIVEN["elsewhere"].values(), *IN_PYTHON.values()]:
        assert who.startswith("needs ") or (ROOT / who).is_file(), who
    for old in GIVEN["python"]:
        assert any(old in text for text in TEXTS.values()), old


def in_running_text():
    """(page, command) of every command with words of its own that stands in running text."""
    for page, text in TEXTS.items():
        for found in re.findall(r"`(innervate [^`|]*)[`|]", text):
            yield page, re.sub(r"\b[A-Z]+\b", "1", " ".join(found.split())).replace("...", "")


def test_commands_in_running_text_have_the_options_that_they_name(monkeypatch):
    monkeypatch.setattr("innervate.network.use", lambda folder: None)
    for page, command in in_running_text():
        try:
            words = line._with_networks(shlex.split(command)[1:])
            line.app.parse_args(words, exit_on_error=False, print_error=False)
        except cyclopts.MissingArgumentError:  # it is spoken of, not given
            continue
        except cyclopts.CycloptsError as error:
            pytest.fail(f"{page}: {command}: {error}")
