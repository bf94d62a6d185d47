"""A library's files in a folder."""

import subprocess
from pathlib import Path
from types import SimpleNamespace

import pytest

from innervate.cli import main
from innervate.firmware import library, tools
from innervate.firmware.errors import FirmwareError
from innervate.networks.mesh.board import node
from tests.own import alone, own

__all__ = ["alone", "own"]
OWN = SimpleNamespace(prefix="own", own_files=("own.h", "own.c"))
FILES = SimpleNamespace(library=OWN, texts={"own.h": "int a;\n"})


def test_a_file_is_there_whole_or_not_at_all(tmp_path, full_disk):
    with full_disk(), pytest.raises(FirmwareError, match=r"own\.h cannot be written"):
        library.write(FILES, tmp_path)
    assert list(tmp_path.iterdir()) == []
    assert library.write(FILES, tmp_path) == {"own.h": 1}
    assert [path.name for path in tmp_path.iterdir()] == ["own.h"]


def test_what_is_left_of_a_sealed_library_is_named(tmp_path, capsys):
    library.write(library.made_of("skin", [], sealed=True), tmp_path)
    bare = library.made_of("skin", [])
    library.write(bare, tmp_path)
    left = library.left(bare, tmp_path)
    assert left == [*library.SEAL, *library.EXAMPLE]
    assert main(["firmware", "skin", "--out", str(tmp_path)]) == 0
    assert f"remove them: {', '.join(left)}\n" in capsys.readouterr().out
    for name in left:
        (tmp_path / name).unlink()
    assert library.left(bare, tmp_path) == []
    assert library.left(library.made_of("skin", [], sealed=True), tmp_path) == [
        "examples/skin_node/skin_node.ino", "bare/skin_main.c"]  # fmt: skip


def test_a_library_has_a_folder(tmp_path):
    (tmp_path / "lib").write_text("")
    with pytest.raises(FirmwareError, match="lib: a file lies here; name a folder"):
        library.write(FILES, tmp_path / "lib")


def test_a_role_is_of_a_network_and_as_large_as_it_has_to_be():
    for name, of in (("skin", "skin"), ("csma", "mesh"), ("mesh", "mesh"), ("rpl", "rpl")):
        network, role = library.role_of(name)
        assert (network.name, role.name) == (of, name)
    network, role = library.role_of("mesh", 33)
    assert (network.name, role) == ("mesh", node(33))
    assert role != library.role_of("mesh")[1]
    with pytest.raises(FirmwareError, match="csma: its arrays do not depend on how many nodes"):
        library.role_of("csma", 33)
    with pytest.raises(FirmwareError, match="nobody: no folder, and none of skin, radio, "):
        library.role_of("nobody")


@pytest.mark.parametrize(("script", "said"), [
    ("echo a; echo b >&2", None), ("echo a; echo b >&2; exit 3", "sh: b"),
    ("echo a; echo b; exit 3", "sh: a"), ("exit 3", "sh: exit code 3"),
    ("echo a; echo an error; exit 1", "sh: an error"),
])  # fmt: skip
def test_a_tool_that_does_not_get_through_says_why_in_a_line(script, said):
    if said is None:
        assert tools.run("sh", "-c", script) == "a\n"
        return
    with pytest.raises(FirmwareError) as error:
        tools.run("sh", "-c", script)
    assert str(error.value) == said


@pytest.mark.parametrize(("slots", "most"), [(3, 1), (25, 23), (257, 255), (300, 255)])
def test_a_stations_packet_is_as_long_as_its_slots_without_the_crc(slots, most):
    role = SimpleNamespace(driver="station", has_gate=False)
    made = SimpleNamespace(role=role, params={"packet_slots": slots, "per_turn": 4})
    assert library._told(made, "PACKET_BYTES x PER_TURN, HAS_GATE", 0) == f"{most} x 4, 0"
    role.driver, role.has_gate = "node", True
    assert library._told(made, "PACKET_BYTES HAS_GATE", 0) == "PACKET_BYTES gate != 0"


@pytest.mark.parametrize(("word", "given"), [("", "item"), ("    item.value = 3\n", "&own")])
def test_an_item_that_the_protocol_writes_into_is_a_copy_of_the_users(own, word, given):
    own.change("protocol.py", "    node.value = item.value\n",
               f"{word}    node.value = item.value\n")  # fmt: skip
    assert not main(["firmware", "gossip", "--out", "c"])
    source = Path("c/gossip_node.c")
    assert f"now, kind, {given}, " in source.read_text()
    subprocess.run(["gcc", "-std=c99", "-Werror", "-fsyntax-only", source], check=True)
