"""A protocol as C: what compilers say of it, what it says of itself, and what is refused."""

import ast
import re
import shutil
import subprocess
from pathlib import Path

import pytest

import innervate
from boards.roles import roles
from innervate.cli import main
from innervate.dialect import source
from innervate.firmware import library
from innervate.firmware.emit import Library
from innervate.firmware.errors import FirmwareError, Refused
from innervate.live.board import Role
from tests.firmware.made import files_of
from tests.own import alone

__all__ = ["alone"]


def library_of(*words):
    return library.made_of(*words).library


WARNINGS = ["-Wall", "-Wextra", "-Wconversion", "-Werror", "-fsyntax-only"]
COMPILERS = {
    "gcc": ["gcc", "-std=c99", "-pedantic"],
    "clang": ["clang", "-std=c99", "-pedantic"],
    "c++": ["g++", "-x", "c++", "-std=c++11"],
    "cortex-m0": ["arm-none-eabi-gcc", "-std=c99", "-mcpu=cortex-m0", "-mthumb", "-Os"],
    "risc-v": ["riscv64-unknown-elf-gcc", "-std=c99", "-march=rv32imac", "-mabi=ilp32",
               "--specs=picolibc.specs"],
}  # fmt: skip
ROLES = ["skin", "radio", "csma", "mesh"]


def test_what_c_leaves_out_stays_where_proofs_read_it():
    texts, made = library_of("skin", []).texts(), library_of("skin", []).role
    assert made.noted

    def read():
        return [ast.dump(one.node) for one in source.functions(made.entry, shared=True).values()]

    before = read()
    assert any(f"attr='{name}', ctx=Store()" in text for text in before for name in made.noted)
    assert not any(name in text for name in made.noted for text in texts.values())
    assert read() == before


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    folder = tmp_path_factory.mktemp("lib")
    for role in ROLES:
        library.write(files_of(role), folder / role)
    return folder


@pytest.mark.parametrize("name", COMPILERS)
def test_compilers_have_nothing_to_say(made, name):
    command = COMPILERS[name]
    if shutil.which(command[0]) is None:
        pytest.skip(f"{command[0]} is not installed")
    for role in ROLES:
        source = made / role / f"{role}.c"
        done = subprocess.run([*command, *WARNINGS, source], capture_output=True, text=True)
        assert done.returncode == 0, done.stderr[:2000]


@pytest.mark.parametrize("value", [0, 1])
def test_what_is_made_in_is_a_number_and_no_field(value):
    """A branch that is never taken takes no room; the other parameters stay fields."""
    made = library.made_of("mesh", [f"on_demand={value}"]).library
    source = made.source()
    assert "params->on_demand" not in source
    assert "params->failover" in source
    assert f"if ({value} && frame->dest != MESH_ALL)" in source
    assert "params->on_demand" in Library(roles()["mesh"], {}).source(), "which tests hold"


def test_nothing_of_libc_is_included_and_everything_has_the_prefix(made):
    for role in ROLES:
        text = "".join((made / role / f"{role}.{end}").read_text() for end in "hc")
        assert set(re.findall(r"#include (\S+)", text)) == {"<stdint.h>", f'"{role}.h"'}
        defined = re.findall(r"^(?:static )?[\w *]*?[ *](\w+)\(.*\)?,?$", text, re.MULTILINE)
        assert len(defined) > 10
        assert [name for name in defined if not name.startswith(f"{role}_")] == []
        named = re.findall(r"#define (\w+)", text)
        assert [name for name in named if not name.startswith(role.upper())] == []


def test_every_function_says_where_it_comes_from(made):
    text = (made / "skin" / "skin.c").read_text()
    said = re.search(r"\* (innervate/\S+cell\.py):(\d+) \*/\nstatic .*skin_forward\(", text)
    path, line = said.groups()
    lines = (Path(innervate.__file__).parents[1] / path).read_text().splitlines()
    assert lines[int(line) - 1].startswith("def forward(")
    assert "/* as last heard; sq_own is that of the last choice */" in text
    assert "Pass a data frame on toward the PC." in text


def test_the_same_source_has_the_same_hash_and_another_has_another():
    one, other = library_of("skin", []), library_of("skin", ["beacon_us=5000"])
    assert one.digest() == other.digest()
    assert one.source() != other.source()
    assert f'"{one.digest()}"' in one.header()
    wider = one.role._replace(room=13)
    assert Library(wider, {}).digest() == one.digest()
    narrow = tuple((n, many, low, min(high, 100), *rest) for n, many, low, high, *rest
                   in one.role.frame)  # fmt: skip
    assert Library(one.role._replace(frame=narrow, item=narrow), {}).digest() != one.digest()


STATE = (("x", 0, 0, 255, "number", "a number"), ("y", 2, 0, 9, "number", "two numbers"))


def role_of(tmp_path, monkeypatch, body, name):
    (tmp_path / f"{name}.py").write_text(
        '"""Doc."""\n\n\ndef on_timer(state, params, now, timer, out):\n    """Doc."""\n'
        + "".join(f"    {line}\n" for line in body.splitlines())
    )
    monkeypatch.syspath_prepend(tmp_path)
    return Role("own", name, STATE, (), STATE, STATE, {})


BAD = {
    "a list": "state.x = [1]",
    "a string": 'state.x = "1"',
    "a float": "state.x = 1.5",
    "a field that is not declared": "state.z = 1",
    "a name that is none": "state.x = other",
    "a name that is none, added": "state.x += other",
    "a field that is not declared, added": "state.x += state.z",
    "an array, added": "state.x += state.y",
    "a call of nothing": "state.x = len(state.y)",
    "a keyword": "state.x = max(1, b=2)",
    "a power": "state.x = 2 ** now",
    "a try": "try:\n    state.x = 1\nfinally:\n    pass",
    "an array as a number": "state.x = state.y",
    "a number as an array": "state.x = state.x[1]",
    "two things": "a = state\na = 1",
    "a large number": "state.x = 4294967296",
    "in": "if now in state.y:\n    pass",
    "a for over an array": "for i in state.y:\n    pass",
    "or of numbers": "state.x = now or timer",
    "itself": "on_timer(state, params, now, timer, out)",
}


@pytest.mark.parametrize("what", BAD)
def test_what_is_outside_the_dialect_is_refused_with_file_and_line(tmp_path, monkeypatch, what):
    name = f"bad_{list(BAD).index(what)}"
    role = role_of(tmp_path, monkeypatch, BAD[what], name)
    with pytest.raises(Refused) as refused:
        Library(role, {})
    assert re.match(rf"\S*{name}\.py:\d+: .+", str(refused.value))
    assert "\n" not in str(refused.value)


def test_what_is_not_there_or_does_not_fit_is_one_line(alone, capsys):
    tmp_path = alone
    (tmp_path / "bare").mkdir()
    (tmp_path / "bare" / "network.py").write_text(
        "from innervate.network import Network\n"
        'NETWORK = Network("bare", __package__, model="a", check="b", plan="c")\n'
    )
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "mine.txt").write_text("mine")
    (tmp_path / "bare" / "__init__.py").touch()
    cases = {
        ("nothing",): "no folder, and none of",
        (str(tmp_path),): "holds no network.py",
        (str(tmp_path / "bare"),): "declares no `protocol` and `fields` and `frames`",
        ("skin", "beacon_us=1"): "beacon_us = 1 must be 100 to",
        ("skin", "beacon_us"): "give a whole number",
        ("skin", "--nodes", "40"): "do not depend on",
        ("mesh", "--nodes", "400"): "hold 1 to 254",
        ("mesh", "nodes=40"): "40 nodes do not fit into a class of 32",
        ("mesh", "queue=9"): "does not fit into 8 places",
        ("mesh", "monitor=32"): "monitor=32 is none of 32 nodes",
        ("radio", "packet_slots=300"): "frames of up to 316 bytes; lines carry 245",
        ("radio", "packet_slots=230"): "frames of up to 246 bytes; lines carry 245",
        ("radio", "--sealed"): "--sealed is for nodes that speak on lines",
        ("skin", "--prefix", "9x"): "begin with a letter",
        ("skin", "--out", str(tmp_path / "full")): "not empty",
    }
    for words, said in cases.items():
        assert main(["firmware", *words]) == 2, words
        (line,) = capsys.readouterr().err.splitlines()
        assert said in line
    with pytest.raises(FirmwareError, match=r"not in 100\.\.1000000"):
        Library(library_of("skin", []).role, {"beacon_us": 1}).source()


def test_a_line_carries_frames_that_just_fit(tmp_path):
    assert main(["firmware", "radio", "packet_slots=229", "--out", str(tmp_path)]) == 0


def test_a_class_is_as_large_as_it_has_to_be(tmp_path):
    assert main(["firmware", "mesh", "--nodes", "40", "--out", str(tmp_path)]) == 0
    assert "#define MESH_NODES 64 " in (tmp_path / "mesh.h").read_text()
    assert "uint8_t next[128];" in (tmp_path / "mesh.h").read_text()
