"""The protocols' C against their Python: every call both ways, replayed and drawn."""

import shutil

import pytest

from boards.errors import BoardFailed
from boards.firmware import __main__ as parity
from boards.firmware.native import SANITIZED, Native, compiler, run
from boards.roles import roles
from innervate.firmware.emit import Library

CALLS = {"skin": 6000, "csma": 3000, "radio": 3000, "mesh": 1200}


@pytest.fixture(autouse=True)
def compilers():
    if shutil.which("gcc") is None:
        pytest.skip("gcc is not installed")


@pytest.mark.parametrize("name", CALLS)
def test_c_does_call_by_call_what_python_does(name):
    replayed, drawn = parity.compare(roles()[name], CALLS[name], 1, sanitized=name != "mesh")
    assert replayed >= CALLS[name] // 2
    assert replayed + drawn == CALLS[name]


@pytest.mark.parametrize("name", ["skin", "radio"])
def test_emulated_processors_do_what_this_one_does(name):
    for tool in ("arm-none-eabi-gcc", "riscv64-unknown-elf-gcc", "qemu-system-arm",
                 "qemu-system-riscv32"):  # fmt: skip
        if shutil.which(tool) is None:
            pytest.skip(f"{tool} is not installed")
    found = parity.emulate(roles()[name], 600, 3)
    assert set(found) == {"here", "cortex-m0", "cortex-m3", "risc-v"}
    assert {one.mark for one in found.values()} == {found["here"].mark}
    assert sum(found["risc-v"].calls.values()) == 600


def test_another_hash_is_found(monkeypatch):
    play = parity.qemu.on_host
    monkeypatch.setattr(parity.qemu, "on_host", lambda *given: play(*given)._replace(mark=7))
    if shutil.which("qemu-system-arm") is None or shutil.which("arm-none-eabi-gcc") is None:
        pytest.skip("arm-none-eabi-gcc or qemu-system-arm is not installed")
    with pytest.raises(BoardFailed, match="cortex-m0: hash"):
        parity.emulate(roles()["csma"], 50, 1)


@pytest.mark.slow
@pytest.mark.parametrize("name", CALLS)
def test_a_hundred_thousand_calls_on_emulated_processors(name):
    assert len(parity.emulate(roles()[name], 100_000, 2)) == 4


@pytest.mark.slow
@pytest.mark.parametrize("name", CALLS)
def test_a_million_calls(name):
    assert sum(parity.compare(roles()[name], 1_000_000, 2, sanitized=True)) == 1_000_000


MISTAKES = {
    "state": ("cell->fd_dist = (uint8_t)dist;", "cell->fd_dist = 0;"),
    "outbox": ("SKIN_URGENT | SKIN_FLUSH", "SKIN_URGENT"),
    "frame": ("onward->hops = (uint8_t)(frame->hops + 1)", "onward->hops = frame->hops"),
    "rounding": ("cell->wait = (uint16_t)(params->k + 3 + params->k / 8)", "cell->wait = 3"),
}


@pytest.mark.parametrize("what", MISTAKES)
def test_a_mistake_in_c_is_found(what, tmp_path, monkeypatch):
    old, new = MISTAKES[what]
    source = Library.source

    def wrong(self, header):
        text = source(self, header)
        assert old in text
        return text.replace(old, new, 1)

    monkeypatch.setattr(Library, "source", wrong)
    native = Native(Library(roles()["skin"], {}), tmp_path)
    with pytest.raises(BoardFailed, match="but in C"):
        parity.replay(native, 20_000, 1)


def test_a_sum_that_does_not_fit_is_found(tmp_path):
    """Natives are compiled so that an overflow ends the program, and does not go on."""
    (tmp_path / "sum.c").write_text(
        "int main(int count, char **words) { (void)words; return count + 2147483647 == 0; }\n"
    )
    run([compiler(), *SANITIZED, tmp_path / "sum.c", "-o", tmp_path / "sum"])
    with pytest.raises(BoardFailed, match="signed integer overflow"):
        run([tmp_path / "sum"])
