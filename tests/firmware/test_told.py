"""What an emulated board says of itself, byte by byte, and what its engine makes of it."""

from types import SimpleNamespace as Of

import pytest

from innervate.firmware.emulated import Emulated


@pytest.fixture
def board():
    """An engine without a board, whose state is six bytes; what it did stands in `did`."""
    engine = object.__new__(Emulated)
    engine.did = did = []

    def packed(name):
        return Of(put=lambda data, record: did.append((name, data, record)))

    engine.packed = {name: packed(name) for name in ("state", "frame")}
    engine._state, engine.stack = bytearray(6), Of(node="node", inbox="inbox")
    engine._report = lambda *args: did.append(("report", *args))
    engine._deliver = lambda *args: did.append(("deliver", *args))
    engine._settled = lambda: did.append("settled")
    return engine


def test_a_state_is_taken_when_its_last_part_has_come(board):
    board._told(b"s\x00\x00abcd")
    assert board.did == ["settled"]
    board._told(b"s\x04\x00ef")
    assert board.did[1:] == [("state", b"abcdef", "node"), "settled"]
    board._told(b"s\x00\x00ABCD")
    board._told(b"s\x04\x00EF")
    assert board.did[3:] == ["settled", ("state", b"ABCDEF", "node"), "settled"]


def test_a_report_has_a_code_and_two_numbers_and_a_delivery_its_port_and_frame(board):
    board._told(b"r\x07\x01\x00\x00\x00\xff\xff\xff\xff")
    board._told(b"d\x02frame")
    assert board.did == [
        ("report", 7, 1, -1), "settled", ("frame", b"frame", "inbox"), ("deliver", 2, "inbox"),
        "settled",
    ]  # fmt: skip


def test_what_is_none_of_these_changes_nothing(board):
    board._told(b"x\x00\x00abcdef")
    assert (board.did, board._state) == (["settled"], bytearray(6))
