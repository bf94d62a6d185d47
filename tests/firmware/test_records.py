"""Records as C has them: how wide a number is, where it lies, what it begins with."""

import ctypes
import os
import struct
from types import SimpleNamespace

import pytest

from innervate.firmware import compiled, payloads
from innervate.firmware.errors import FirmwareError
from innervate.firmware.packed import Packed
from innervate.firmware.payloads import cases
from innervate.firmware.records import (
    BYTES,
    TYPES,
    Field,
    fields_of,
    initial,
    layout,
    name_of,
    records_of,
    type_of,
)
from innervate.firmware.records import struct as struct_text
from innervate.firmware.views import struct_of
from innervate.live.board import Role
from innervate.wire.layout import PAIRS, REST


@pytest.mark.parametrize(
    ("low", "high", "name"),
    [
        (0, 0, "uint8_t"), (0, 255, "uint8_t"), (0, 256, "uint16_t"), (-1, 127, "int8_t"),
        (-128, 0, "int8_t"), (-129, 0, "int16_t"), (-1, 128, "int16_t"), (0, 65_535, "uint16_t"),
        (0, 65_536, "int32_t"), (-1, 32_767, "int16_t"), (-1, 32_768, "int32_t"),
        (-32_768, 0, "int16_t"), (-32_769, 0, "int32_t"), (-(1 << 31), (1 << 31) - 1, "int32_t"),
    ],
)  # fmt: skip
def test_a_number_is_as_wide_as_its_range(low, high, name):
    assert type_of(low, high) == name


def test_types_hold_what_they_say():
    for name, (low, high, _) in TYPES.items():
        bits = 8 * BYTES[name]
        least = 0 if name.startswith("u") else -(1 << (bits - 1))
        assert (low, high) == (least, least + (1 << bits) - 1)


@pytest.mark.parametrize(
    ("low", "high", "given", "begins"),
    [(0, 9, None, 0), (3, 9, None, 3), (-9, -2, None, -2), (0, 9, 5, 5), (0, 9, 12, 9),
     (3, 9, 1, 3), (-1, 9, -1, -1)],
)  # fmt: skip
def test_a_field_begins_with_what_is_given_or_what_is_nearest_to_0(low, high, given, begins):
    field = Field("x", type_of(low, high), 0, low, high, "", "")
    assert initial(field, given) == begins


DECLARED = (
    ("wide", 0, 0, 70_000, "us", "a time"), ("many", 3, 0, 255, "x", "bytes"),
    ("flag", 0, 0, 1, "x", "yes */ no"), ("pairs", 2, -300, 300, "x", "halves"),
    ("new", 0, -5, 5, "x", "a word of C"),
)  # fmt: skip


def ordered():
    nothing = (("x", 0, 0, 1, "", ""),)
    role = Role("some", "module", DECLARED, nothing, nothing, nothing, {})
    return records_of(role)["state"]


def test_numbers_stand_before_arrays_and_narrow_ones_first():
    assert list(ordered()) == ["flag", "new", "wide", "many", "pairs"]
    nothing = (("x", 0, 0, 1, "", ""),)
    role = Role("some", "module", DECLARED, nothing, nothing, nothing, {})
    assert list(records_of(role)) == ["state", "params", "frame", "action"]
    other = role._replace(item=(("y", 0, 0, 1, "", ""),), gate=DECLARED)
    assert list(records_of(other)) == ["state", "params", "gate", "frame", "item", "action"]
    with pytest.raises(FirmwareError, match="field x: its length is 'ports'; C needs a number"):
        fields_of((("x", "ports", 0, 1, "", ""),))


def test_records_lie_as_c_lays_them_out():
    for fields in (ordered(), fields_of(DECLARED), dict(reversed(ordered().items()))):
        places, size = layout(fields)
        made = struct_of(fields)
        assert size == ctypes.sizeof(made)
        for name, (offset, kind, length) in places:
            assert offset == getattr(made, name).offset
            assert getattr(made, name).size == BYTES[kind] * max(1, length)
            assert length == fields[name].length


@pytest.mark.parametrize(("most", "size"), [(255, 3), (65_535, 6), (70_000, 12)])
def test_a_record_is_filled_up_to_the_widest_of_its_numbers_alone(most, size):
    fields = fields_of((("x", 0, 0, most, "", ""), ("y", 2, 0, most, "", "")))
    assert layout(fields)[1] == ctypes.sizeof(struct_of(fields)) == size


def test_a_struct_in_c_says_ranges_and_meanings():
    text = struct_text("some_t", ordered(), "what it is").splitlines()
    assert text[0] == "/** what it is */"
    assert "    uint8_t flag; /* 0..1 x: yes * / no */" in text
    assert "    int8_t new_; /* -5..5 x: a word of C */" in text
    assert "    int16_t pairs[2]; /* -300..300 x: halves */" in text
    assert text[-1] == "} some_t;"
    assert (name_of("value"), name_of("register")) == ("value", "register_")


def some(**fields):
    values = {"wide": 1, "many": [1, 2, 255], "flag": 1, "pairs": [-300, 300], "new": -5}
    return SimpleNamespace(**values | fields)


@pytest.mark.parametrize("turn", [list, reversed])
def test_a_record_as_bytes_and_back(turn):
    fields = dict(turn(ordered().items()))
    packed = Packed(fields)
    data = packed.of(some(wide=70_000))
    assert len(data) == packed.size == layout(fields)[1]
    other = some(wide=0, many=[0] * 3, flag=0, pairs=[0, 0], new=0)
    packed.put(data, other)
    assert vars(other) == vars(some(wide=70_000))
    few = SimpleNamespace(flag=0)
    packed.put(data, few)
    assert vars(few) == {"flag": 1}
    made = struct_of(fields).from_buffer_copy(data)
    assert (made.wide, list(made.many), list(made.pairs)) == (70_000, [1, 2, 255], [-300, 300])
    for wrong in ({"many": [1, 2, 256]}, {"flag": 256}, {"pairs": [1, 40_000]}):
        with pytest.raises((ValueError, struct.error)):
            packed.of(some(**wrong))


def test_fields_that_differ_are_named_with_both_values():
    packed = Packed(ordered())
    one, other = packed.of(some()), packed.of(some(flag=0, many=[1, 2, 3]))
    assert packed.differences(one, one) == []
    assert packed.differences(one, other) == [
        "flag: 1 but in C 0", "many: [1, 2, 255] but in C [1, 2, 3]",
    ]  # fmt: skip


@pytest.mark.parametrize(("mode", "is_taken"), [(0o700, True), (0o755, True), (0o720, False),
                                                (0o702, False)])  # fmt: skip
def test_a_library_that_others_may_change_is_never_opened(tmp_path, monkeypatch, mode, is_taken):
    opened = []
    monkeypatch.setattr(ctypes, "CDLL", lambda path: opened.append(path) or "library")
    path = tmp_path / "one.so"
    assert compiled._kept(path, "key") is None, "it is not there"
    path.write_bytes(b"ELF ... key ...")
    path.chmod(mode)
    os.utime(path, (1, 1))
    assert compiled._kept(path, "other key") is None
    assert path.stat().st_mtime == 1
    assert compiled._kept(path, "key") == ("library" if is_taken else None)
    assert opened == [str(path)] * is_taken
    assert (path.stat().st_mtime > 1) == is_taken, "it was used just now"


def test_libraries_that_were_not_used_for_longest_go(tmp_path):
    for age in range(compiled.KEPT_MOST + 2):
        path = tmp_path / f"{age}.so"
        path.touch()
        os.utime(path, (1000 - age, 1000 - age))
    (tmp_path / "one.lock").touch()
    compiled._forget(tmp_path)
    left = {path.name for path in tmp_path.iterdir()}
    assert left == {*(f"{age}.so" for age in range(compiled.KEPT_MOST)), "one.lock"}


def test_payloads_that_are_not_looked_into_have_no_cases():
    assert cases(SimpleNamespace(forms=(SimpleNamespace(payloads={}),))) == []


@pytest.mark.parametrize(("fields", "why"), [
    ((("few", 2, (("n", 0, 8, 0), ("each", "n", 4, 0)), 0),), "few: groups of variable length"),
    ((("count", 0, 8, 0), ("pairs", PAIRS, 8, 0)), "pairs: pairs are no payload"),
])  # fmt: skip
def test_payloads_that_c_does_not_go_through_are_refused(fields, why):
    with pytest.raises(FirmwareError, match=why):
        payloads._walk(fields)


def test_a_payload_is_gone_through_field_by_field_to_its_end():
    groups = ("groups", REST, (("a", 0, 4, 0), ("b", 0, 12, 0)), 0)
    assert payloads._walk((("a", 0, 8, 0), ("b", 3, 4, 0))) == ["return at + 20 == end;"]
    assert payloads._walk(()) == ["return at == end;"]
    assert payloads._walk((("a", 0, 8, 0), ("rest", REST, 16, 0))) == [
        "at += 8;", "return at <= end && (end - at) % 16 == 0;"]  # fmt: skip
    assert payloads._walk((("rest", REST, 8, 0),)) == [
        "return at <= end && (end - at) % 8 == 0;"]  # fmt: skip
    whole = payloads._walk((("a", 0, 8, 0), groups))
    assert (whole[:2], whole[-2:]) == (["at += 8;", "while (at < end) {"],
                                       ["}", "return at == end;"])  # fmt: skip
