"""The protocols' C against their Python: every call both ways, replayed and drawn."""

import io
import shutil
from importlib import import_module

import pytest

from boards.errors import BoardFailed
from boards.firmware import __main__ as parity
from boards.firmware.native import SANITIZED, Native, Twin, compiler, fresh, run
from boards.firmware.replayed import Heard
from boards.firmware.script import Script
from boards.parity import record
from boards.roles import roles
from innervate.dialect import plain
from innervate.firmware.emit import Library
from innervate.live.board import roles_of
from innervate.network import use
from innervate.networks.mesh.board import small_parameters
from innervate.networks.mesh.protocol.constants import BODY, DATA, MESSAGES, TX
from innervate.networks.mesh.protocol.fields import GATHERED
from innervate.networks.mesh.protocol.queue import WAITS
from tests.own import alone, own

__all__ = ["alone", "own"]

CALLS = {"skin": 2000, "csma": 1000, "radio": 1000, "mesh": 600}  # the rest: test_million.py


@pytest.fixture(autouse=True)
def compilers():
    if shutil.which("gcc") is None:
        pytest.skip("gcc is not installed")


@pytest.mark.parametrize("name", CALLS)
def test_c_does_call_by_call_what_python_does(name):
    replayed, drawn = parity.compare(roles()[name], CALLS[name], 1, sanitized=name != "mesh")
    assert replayed >= CALLS[name] // 2
    assert replayed + drawn == CALLS[name]


def test_another_hash_is_found(monkeypatch):
    play = parity.qemu.on_host
    monkeypatch.setattr(parity.qemu, "on_host", lambda *given: play(*given)._replace(marks=[7, 8]))
    if shutil.which("qemu-system-arm") is None or shutil.which("arm-none-eabi-gcc") is None:
        pytest.skip("arm-none-eabi-gcc or qemu-system-arm is not installed")
    with pytest.raises(BoardFailed, match="here: hashes 00000007 00000008, Python "):
        parity.emulate(roles()["csma"], 50, 1)


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

    def wrong(self):
        text = source(self)
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


def full_mesh_node(library):
    """A node that owes acks to as many as can be, and has a queue of frames as long as can be."""
    node = fresh(library, 31, 1)
    node.places, node.busy, node.ack_at, node.acks = len(node.q_state), -1, -1, GATHERED
    node.ack_to[:] = range(GATHERED)
    for i in range(node.places):
        node.q_state[i], node.q_rank[i], node.q_kind[i] = WAITS, MESSAGES, DATA
        node.q_link_dst[i], node.q_path_len[i], node.q_length[i] = i, 1, BODY - 1
    node.neighbour[:] = [255] * len(node.neighbour)
    return node


@pytest.mark.parametrize(("given", "words"), [
    ("", r"has no \[\[input\]\]; write one with it as boards/parity/gossip.toml"),
    ("\n[[input]]\nat_s = 0.1\nkind = 1\n", "make more calls"),
])  # fmt: skip
def test_of_a_scenario_without_an_input_more_calls_are_not_asked_for(
    own, given, words, tmp_path, monkeypatch
):
    role = roles_of(use(own.folder))[0]
    if given:
        monkeypatch.setattr(record, "HERE", tmp_path)
        (tmp_path / "gossip.toml").write_text(f'kind = "gossip"\n{given}')
    with pytest.raises(BoardFailed, match=words):
        parity.draw(Library(role, {}), Heard(), 1, Script(io.BytesIO()), 9)


@pytest.mark.parametrize("lacks", [0, 500])
def test_the_longest_frames_of_one_call_have_room(lacks, tmp_path):
    role = roles()["mesh"]
    role = role._replace(frame_bytes=role.frame_bytes - lacks)
    library = Library(role, {})
    node, params = full_mesh_node(library), plain.make("Params", role.params)()
    for name, value in small_parameters({"gather": 1, "hop_frames": 4}).items():
        setattr(params, name, value)
    native = Native(library, tmp_path, sanitized=True, level="-O0")
    twin, out = Twin(native, node), plain.Outbox(plain.make("Frame", role.frame), role.room)
    packed = native.records["params"].of(params)
    import_module(role.entry).on_timer(node, None, params, 0, TX, out)
    assert sum(act.kind == 1 for act in out.action[: out.count[0]]) == GATHERED + node.places
    twin.call("on_timer", packed, 0, (TX,))
    found = twin.compare(out)
    assert ("overflow 1" in str(found)) == (lacks > 0), found
    assert lacks or found == []
