"""The protocols' own functions on MicroPython and on an emulated micro:bit, call by call."""

import dataclasses
import functools
from types import SimpleNamespace

import pytest

from boards import __main__ as build
from boards import join, records
from boards.errors import BoardFailed, BoardMissing
from boards.firmware import __main__ as firmware
from boards.parity import __main__ as parity
from boards.parity import microbit, nodejs, record, replay
from boards.roles import roles
from innervate.network import networks

CALLS = {
    "skin": 500,
    "csma": 300,
    "radio": 300,
    "mesh": 120,
    "babel": 200,
    "flooding": 100,
    "rpl": 100,
}  # a minute of a mesh takes ten seconds
MICROBIT_CALLS = 12
ROLES = roles()


@functools.cache
def transcript(name):
    return record.record(ROLES[name])


def first(name, calls):
    whole = transcript(name)
    return dataclasses.replace(whole, calls=whole.calls[:calls], marks=whole.marks[:calls])


def play(play_on, *args):
    try:
        return play_on(*args)
    except BoardMissing as missing:
        pytest.skip(str(missing))


def changed_node(monkeypatch, old, new):
    """The next node's source with a mistake in it."""
    joined = join.joined

    def wrong(entry, noted):
        source = joined(entry, noted=noted)
        assert source.count(old) == 1, old
        return source.replace(old, new)

    monkeypatch.setattr(join, "joined", wrong)


@pytest.mark.parametrize("name", ROLES)
def test_micropython_does_what_the_simulator_does(name):
    part = first(name, CALLS[name])
    played = play(nodejs.play, part)
    assert played.marks == part.marks
    assert 0 < played.state < played.node < played.most <= nodejs.CAP
    assert played.left < nodejs.CAP
    if ROLES[name].in_ram:
        assert played.code + played.node < played.most


def test_the_heap_is_really_capped():
    files = nodejs.files_of(ROLES["csma"])
    size = play(nodejs.run, files, nodejs.CAP, "import board", "=board.left").split()[-1]
    assert 8_000 < int(size) < nodejs.CAP
    with pytest.raises(BoardFailed, match="MemoryError"):
        nodejs.run(files, nodejs.CAP, f"x = bytearray({nodejs.CAP})")


def test_a_mistake_in_the_node_is_noticed(monkeypatch):
    changed_node(monkeypatch, "cell.seq + 1 & 255", "cell.seq + 2 & 255")
    part = first("skin", CALLS["skin"])
    played = play(nodejs.play, part)
    assert len(played.marks) == len(part.marks)
    assert played.marks != part.marks


def test_the_micro_bit_does_what_the_simulator_does():
    part = first("skin", MICROBIT_CALLS)
    assert play(microbit.play, part, MICROBIT_CALLS) == part.marks


@pytest.mark.parametrize("name", ROLES)
def test_joined_functions_are_the_same_functions(name):
    """On this Python, for whole transcripts, and with records as boards have them."""
    role, recorded = ROLES[name], transcript(name)
    space = {}
    exec(join.joined(role.entry, noted=role.noted), space)
    exec(nodejs.records_of(role), space)
    exec(nodejs.layouts_of(role), space)
    outbox = {}
    exec((nodejs.BOARD / "outbox.py").read_text(), outbox)
    feed = iter(nodejs.script_of(recorded))

    def read():
        return replay.number(feed.__next__)

    params, state, frame = space["Params"](), space["State"](), space["Frame"]()
    replay.read_record(params, space["PARAMS"], read)
    who = (state, None, params) if space["HAS_GATE"] else (state, params)
    handlers = [space.get(handler) for handler in record.HANDLERS]
    item = space.get("Item", lambda: frame)()
    out = outbox["Outbox"](space["Frame"], role.room)
    player = replay.Player(handlers, who, frame, item, out, SimpleNamespace(**space), read)
    assert list(iter(player.step, None)) == recorded.marks
    assert recorded.room <= role.room
    assert len(out.frame.made) <= recorded.room


@pytest.mark.parametrize("name", ["skin", "radio", pytest.param("mesh", marks=pytest.mark.slow)])
def test_the_compiled_run_ends_in_the_same_state(name):
    recorded = transcript(name)
    assert record.compiled_mark(ROLES[name]) == (recorded.marks[-1][0], recorded.fingerprint)


@pytest.mark.slow
def test_the_whole_command(capsys):
    try:
        assert parity.main([]) == 0
    finally:
        said = capsys.readouterr()
    assert said.out.count("each the same") == len(ROLES) + 1, said.err


def test_an_unknown_protocol_is_the_users_mistake(capsys):
    assert parity.main(["skni"]) == 2
    assert "known: skin, radio, csma, mesh" in capsys.readouterr().err


@pytest.mark.parametrize("command", [build, parity, firmware])
def test_a_folder_that_is_no_network_is_one_line(tmp_path, monkeypatch, capsys, command):
    """INNERVATE_NETWORKS names the networks' own folders, and not the one that they are in."""
    monkeypatch.setenv("INNERVATE_NETWORKS", str(tmp_path))
    networks.cache_clear()
    try:
        assert command.main(["gossip"]) == 2
    finally:
        monkeypatch.undo()
        networks.cache_clear()
    assert capsys.readouterr().err == f"{tmp_path} holds no network.py\n"


@pytest.mark.parametrize(
    ("home", "said"), [("empty", "Node.js is missing"), ("with node", "npm is missing")]
)
def test_what_is_missing_is_one_line(tmp_path, monkeypatch, capsys, home, said):
    if home == "with node":
        (tmp_path / "node").touch(0o755)
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setenv("INNERVATE_CACHE", str(tmp_path / "cache"))
    assert parity.main(["csma"]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert said in line


@pytest.mark.parametrize("number", [0, 1, -1, 31, 32, -513, 1 << 16, (1 << 30) - 1, -(1 << 30)])
def test_numbers_travel_as_characters(number):
    feed = iter(nodejs.encoded(number))
    assert replay.number(feed.__next__) == number
    assert next(feed, None) is None


@pytest.mark.parametrize(
    ("low", "high", "code"),
    [(0, 1, "B"), (-1, 3, "b"), (0, 256, "H"), (-129, 5, "h"), (0, 70_000, "i")],
)
def test_arrays_are_as_narrow_as_their_range_allows(low, high, code):
    assert records.code_of(low, high) == code
    field = ("x", 3, low, high, "", "")
    space = {}
    exec(records.module_source(Made=(field,)), space)
    made = space["Made"]()
    made.x[0], made.x[2] = low, high
    assert list(made.x) == [low, 0, high]


def test_short_names_are_no_words_of_the_language():
    import keyword

    names = [join.short(i) for i in range(2000)]
    assert len(set(names)) == len(names)
    assert not any(map(keyword.iskeyword, names))
