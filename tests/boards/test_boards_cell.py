"""The cell that goes to a board: the folder, and two of them on real serial ports with a PC."""

import ast
import asyncio
import contextlib
import re
import subprocess
import tomllib
from types import SimpleNamespace

import pytest

from boards import __main__ as build
from boards.errors import BoardMissing
from boards.parity import nodejs, replay
from boards.roles import roles
from innervate.dialect import outbox, rng
from innervate.live import nodefile
from innervate.live.serial import SerialLink
from innervate.live.serial_cables import Cables
from innervate.networks.skin.live.node import SinkNode
from innervate.networks.skin.live.parameters import skin_parameters
from innervate.networks.skin.live.stack import SinkStack
from innervate.networks.skin.protocol import constants as skin_const
from tests.live.net import until

FAR_SAMPLES = 5
PARAMS = {"beacon_us": 40_000, "skip_us": 24_000, "k": 8, "r_f": 105, "r_r": 105}


@pytest.fixture(scope="module")
def files():
    try:
        nodejs.home()
        return build.files_of(roles()["skin"], skin_parameters(PARAMS))
    except BoardMissing as missing:
        pytest.skip(str(missing))


def folder_of(path, files, number, uarts):
    """A board's folder, with main.py changed as a maker does."""
    main = files["main.py"].decode().replace("NUMBER = 1", f"NUMBER = {number}")
    main = re.sub(r"UARTS = \(\n.*?\n\)", f"UARTS = {uarts!r}", main, flags=re.DOTALL)
    # What the PC commands comes back as what the cell feels.
    main = main.replace("frame.proximity = 0", "frame.proximity = told[0]")
    words = '"""Do what the PC commands; what code and value mean is yours."""\n'
    assert words in main
    main = "told = [0]\n" + main.replace(words, words + "    told[0] = code + value\n")
    machine = (nodejs.HERE / "machine.py").read_bytes()
    nodejs.write(path, {**files, "main.py": main.encode(), "machine.py": machine})
    return path


@contextlib.contextmanager
def board(folder, *devices):
    """A process that is a board with these serial ports as UARTs 0, 1 ..."""
    command = ["node", nodejs.HERE / "cell.mjs", nodejs.home(), folder, *devices]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    try:
        yield process
    finally:
        process.kill()
        process.communicate()


async def command(pc, arrived, *what, **to):
    """Command until it arrived: nobody acknowledges one that a port read late has lost."""
    for tries in range(5, -1, -1):
        pc.send_command(*what, **to)
        try:
            return await until(arrived, 4)
        except AssertionError:
            if not tries:
                raise


def test_two_boards_and_a_pc_on_serial_cables(tmp_path, files):
    async def main():
        cables = Cables(2)
        cables.start()
        near = folder_of(tmp_path / "near", files, 7, ((0, {}), (1, {}), None, None))
        far = folder_of(tmp_path / "far", files, 8, (None, None, (0, {}), None))
        heard = {7: [], 8: []}
        link = SerialLink(cables.devices[0], 1_000_000)
        pc = SinkNode("pc", SinkStack(skin_parameters(PARAMS), 1), [link])
        pc.receive_touch(lambda touch: heard[touch.cell].append(touch))
        with board(near, *cables.devices[1:3]), board(far, cables.devices[3]):
            await pc.start()
            await until(lambda: len(heard[8]) >= FAR_SAMPLES and pc.status()["cells"] == [2])
            await command(pc, lambda: heard[8][-1].proximity == 503, 3, 500, cell=8)
            assert heard[7][-1].proximity == 0
            everywhere = {7: 100, 8: 100}
            await command(pc, lambda: {n: heard[n][-1].proximity for n in (7, 8)} == everywhere,
                          4, 96)  # fmt: skip
            cables.cut = {1}
            count = len(heard[8])
            await until(lambda: pc.status()["cells"] == [1])
            lost = len(heard[8]) - count
            cables.cut = set()
            await until(lambda: len(heard[8]) > count + lost + FAR_SAMPLES)
        await pc.stop()
        cables.stop()
        return heard

    heard = asyncio.run(main())
    assert {touch.hops for touch in heard[7]} == {0}
    assert {touch.hops for touch in heard[8]} == {1}


def test_the_folder_is_made_and_made_again(tmp_path, capsys, files):
    made = tmp_path / "board"
    for _ in range(2):
        assert build.main([str(made), "beacon_us=10000"]) == 0
    names = {str(path.relative_to(made)) for path in made.rglob("*") if path.is_file()}
    assert names == set(files)
    assert "mpremote" in capsys.readouterr().out


def test_what_a_maker_wrote_stays_when_the_folder_is_made_again(tmp_path, capsys):
    made = tmp_path / "board"
    assert build.main([str(made)]) == 0
    (made / "main.py").write_text("NUMBER = 7\n")
    (made / "sensors.py").write_text("mine")
    node = (made / "node.mpy").read_bytes()
    assert build.main([str(made), "k=9"]) == 0
    assert f"{made}/main.py is yours, and stays as it is" in capsys.readouterr().out
    assert (made / "main.py").read_text() == "NUMBER = 7\n"
    assert (made / "sensors.py").read_text() == "mine"
    assert (made / "node.mpy").read_bytes() != node


def test_a_file_is_no_folder_for_a_board(tmp_path, capsys):
    (tmp_path / "board").write_text("mine")
    assert build.main([str(tmp_path / "board")]) == 2
    assert "not made by this command; name another" in capsys.readouterr().err
    assert build.main([str(tmp_path / "board" / "of")]) == 2
    assert "cannot be written: Not a directory" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("arguments", "said"),
    [(["k=x"], "whole number"), (["kk=3"], "protocol.kk is unknown"),
     (["k=0"], "must be 1 to 840"), (["a", "b"], "one folder"),
     (["mesh", "a"],
      "for boards; the skin and networks of your own over cables or a field have one"),
     (["--out", "a"], "--out: no such option; see --help")],
)  # fmt: skip
def test_a_mistake_is_one_line_and_leaves_nothing(tmp_path, monkeypatch, capsys, arguments, said):
    monkeypatch.chdir(tmp_path)
    assert build.main(arguments) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert said in line
    assert list(tmp_path.iterdir()) == []


def test_who_asks_for_help_is_told_and_nothing_is_made(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert build.main(["--help"]) == 0
    assert "[NETWORK] [FOLDER] [name=value ...]" in capsys.readouterr().out
    assert list(tmp_path.iterdir()) == []


def test_a_folder_of_something_else_is_left_alone(tmp_path, capsys, files):
    (tmp_path / "thesis.txt").write_text("mine")
    assert build.main([str(tmp_path)]) == 2
    assert "not empty" in capsys.readouterr().err
    assert [path.name for path in tmp_path.iterdir()] == ["thesis.txt"]


def test_the_readme_is_right():
    text = (build.HERE / "README.md").read_text(encoding="utf-8")
    (node_file,) = re.findall(r"```toml\n(.*?)```", text, re.DOTALL)
    assert nodefile.parse(tomllib.loads(node_file)).role == "sink"
    (uarts,) = re.findall(r"```python\n(UARTS.*?)```", text, re.DOTALL)
    space = {"machine": SimpleNamespace(Pin=int)}
    exec(uarts, space)
    assert len(space["UARTS"]) == 4
    for target in re.findall(r"\]\(([^)#]+)", text):
        assert (build.HERE / target).exists(), target


def test_the_whole_folder_takes_as_much_memory_as_the_documents_say():
    uart = "class Uart:\n    def any(self): return 0\n    def read(self, *_): return None\n"
    steps = (
        f"import gc\n{uart}", "before = gc.mem_alloc()", "from cell import Cell",
        "cell = Cell(1, [Uart() for _ in range(4)], 7, lambda frame: None, 20_000)",
        "print(gc.mem_alloc() - before)",
    )  # fmt: skip
    try:
        made = build.files_of(roles()["skin"], skin_parameters({}))
        taken = int(nodejs.run(made, 256 * 1024, *steps))
    except BoardMissing as missing:
        pytest.skip(str(missing))
    readme = (build.HERE / "README.md").read_text(encoding="utf-8")
    page = (build.HERE.parents[1] / "docs" / "boards.md").read_text(encoding="utf-8")
    for text in (readme, page):
        (said,) = re.findall(r"(?:a cell with four UARTs \||boards skin`, takes) ([\d,]+)", text)
        assert abs(int(said.replace(",", "")) - taken) < 100


def test_what_the_boards_files_repeat_is_the_protocols():
    for path in (build.HERE / "driver.py", build.HERE / "cell.py", nodejs.HERE / "replay.py"):
        for node in ast.parse(path.read_text(encoding="utf-8")).body:
            if isinstance(node, ast.Assign) and isinstance(node.value, ast.Constant):
                (name,) = (target.id for target in node.targets)
                for module in (outbox, skin_const):
                    assert getattr(module, name, node.value.value) == node.value.value, name
    assert replay.fold(77, 0) == rng.step(77)
