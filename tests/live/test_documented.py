"""The Python example of docs/live.md does what it says, beside a gateway that has just started."""

import asyncio
import re
from pathlib import Path

import pytest

from innervate.live.build import build
from innervate.live.errors import LiveError
from innervate.live.nodefile import load
from tests.fixtures.node_files import LINK, of_mesh
from tests.live.test_process import free_port

PAGE = Path(__file__).parents[2] / "docs" / "live.md"
BETWEEN = LINK.replace(":0", ":{own}").replace(":9", ":{other}")
NODE = of_mesh("{number}", 4, 'role = "{role}"', BETWEEN)


def test_the_documented_node_waits_for_its_table_and_delivers(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(tmp_path))
    own, other = free_port(), free_port()
    Path("n0.toml").write_text(NODE.format(number=0, role="node", own=own, other=other))
    Path("n3.toml").write_text(NODE.format(number=3, role="gateway", own=other, other=own))
    asyncio.run(asyncio.wait_for(_beside(_snippet()), 60))
    assert capsys.readouterr().out.splitlines() == ["delivered", "3 b'hello'"]


def test_the_documented_node_file_is_one(tmp_path):
    (text,) = re.findall(r"```toml\n(kind = .*?)```", PAGE.read_text("utf-8"), re.DOTALL)
    (tmp_path / "net.key").write_text("ab" * 32)
    (tmp_path / "n3.toml").write_text(text)
    node = build(load(tmp_path / "n3.toml"))
    assert [path.name.partition(" ")[0] for path in node.paths] == ["udp", "udp", "serial", "udp"]


def _snippet():
    (code,) = re.findall(r"```python\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)
    names = {}
    exec(code, names)
    return names["main"]


async def _beside(snippet):
    """Run it until its message was answered, beside node 3, which starts at the same moment."""
    async with build(load(Path("n3.toml"))) as far:
        running = asyncio.create_task(snippet())
        sender, payload = await anext(far.receive_messages())
        assert await far.send_message(sender, payload).wait() == "delivered"
        await asyncio.sleep(0)  # lets the example print what it was given
        running.cancel()
        await asyncio.gather(running, return_exceptions=True)


def test_commands_of_pages_are_marked_as_such():
    for page in (PAGE.parents[1] / "README.md", *PAGE.parent.glob("*.md")):
        for block in re.findall(r"```console\n(.*?)```", page.read_text("utf-8"), re.DOTALL):
            bare = [line for line in block.splitlines() if re.match(r"(innervate|make|pip) ", line)]
            assert not bare, (page.name, bare)


DEFAULTS = ("engine", "grace_s", "ends", "wait_ms", "buffer", "far")


def node_file(text, folder):
    path = folder / "node.toml"
    path.write_text(text, encoding="utf-8")
    return load(path).table


def test_the_documented_node_file_is_one_and_names_the_defaults(tmp_path):
    """What its comments do not call left out is as it would be if it were left out."""
    (text,) = re.findall(r"## A node file\n\n```toml\n(.*?)```", PAGE.read_text("utf-8"), re.DOTALL)
    given = [line for line in text.splitlines() if line.partition(" ")[0] in DEFAULTS]
    assert sorted(line.partition(" ")[0] for line in given) == sorted(DEFAULTS)
    short = "\n".join(line for line in text.splitlines() if line not in given)
    assert node_file(text, tmp_path) == node_file(short, tmp_path)
    # It takes the second role's key only with that role.
    assert node_file(text, tmp_path).keys.grace_s == 10


@pytest.mark.parametrize("engine", ["python", "auto", "c"])
def test_only_who_insists_on_c_is_refused_where_nothing_compiles_it(tmp_path, monkeypatch, engine):
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setenv("CC", "")
    monkeypatch.setenv("INNERVATE_CACHE", str(tmp_path / "cache"))
    path = tmp_path / "n0.toml"
    path.write_text(NODE.format(number=0, role="node", own=0, other=1))
    if engine == "c":
        with pytest.raises(LiveError, match=r'engine = "c": .*; or write engine = "auto"'):
            build(load(path), engine)
    else:
        not_asked = build(load(path), engine).not_in_c == "not asked for"
        assert not_asked == (engine == "python")
