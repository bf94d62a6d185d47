"""Expressions and statements that no protocol has (yet), in C and in Python: they do the same."""

import ctypes
import importlib
import random
import shutil

import pytest

from boards.firmware.native import run
from innervate.firmware.emit import Library
from innervate.firmware.errors import Refused
from innervate.firmware.packed import Packed
from innervate.live.board import Role

DRAWN, WRITTEN, CALLS = 90, 50, 60
NUMBER = (-(1 << 31), (1 << 31) - 1, "number", "")
STATE = (
    ("a", 0, -40, 40, "number", ""), ("b", 0, -40, 40, "number", ""),
    ("n", 0, 1, 40, "number", ""), ("m", 0, 1, 40, "number", ""),
    ("p", 0, 0, 1, "flag", ""), ("q", 0, 0, 1, "flag", ""), ("byte", 0, 0, 255, "number", ""),
    ("half", 0, -32768, 32767, "number", ""), ("list", 4, 0, 9, "number", ""),
    ("r", DRAWN + WRITTEN, *NUMBER),
)  # fmt: skip
FRAME = (("x", 0, *NUMBER), ("list", 4, 0, 9, "number", ""))
BEGIN = '''"""Doc."""

FOUR = 4
MINUS = -7

def on_timer(state, params, now, timer, out):
    """Doc."""
'''
# Statements: each function is given the state and `now`, and may change the state.
FUNCTIONS = '''
def early(state, now):
    """Doc."""
    if state.a > 3:
        return 1
    elif state.b > 3:
        return 2
    state.half = state.a * 9


def last(state, now):
    """Doc."""
    i = 7
    for i in range(state.n & 3):
        if state.list[i] == 3:
            break
    return i


def counted(state, now):
    """Doc."""
    total = 0
    n = 3
    for i in range(1, n):
        n = n + 2
        if i & 1:
            continue
        total += 10 * n + i
    return total + n


def set_inside(state, now):
    """Doc."""
    total = 0
    for i in range(4):
        total = total * 3 + i
        i = i + 5
        total += i
    return total


def grows(state, now):
    """Doc."""
    for i in range(state.n & 3):
        state.n = state.n + i + 1
    return state.n


def while_(state, now):
    """Doc."""
    left = state.n
    while left > 2 and not (left & 8):
        left -= 3
        if left == state.m:
            break
    return left


def narrow(state, now):
    """Doc."""
    state.byte = (state.a + 40) * 3
    state.half = state.byte - state.n
    state.list[state.n & 3] = state.m & 7
    state.byte ^= 0
    state.half -= state.a
    state.byte //= 2
    return state.half


def bump(values, at):
    """Doc."""
    values[at] = values[at] + 1 & 7
    return values[at]


def passes(state, now):
    """Doc."""
    values = state.list
    first = bump(values, 0)
    second = bump(state.list, state.n & 3)
    return first * 10 + second


def total(values, count):
    """Doc."""
    found = 0
    for i in range(count):
        found += values[i]
    return found


def twins(state, now):
    """Doc."""
    return total(state.list, 4) * 10 + total(state.r, 2)


def unused(state, now):
    """Doc."""
    for _ in range(3):
        state.half = state.half & 63
    return 0


def either(state, now):
    """Doc."""
    if state.p:
        found = state.a
    else:
        found = state.b
    if found < 0:
        if state.q:
            return found - 100
    else:
        return found + 100
'''
NAMES = ("early", "last", "counted", "set_inside", "grows", "while_", "narrow", "passes",
         "twins", "unused", "either")  # fmt: skip
HAND = (
    "state.a - (state.b - state.n)", "state.a - state.b - state.n", "state.a - -state.b",
    "state.n // 4 // 2", "state.n // (state.m // 8 + 1)", "state.n % state.m % 3",
    "state.a // 4", "state.a % 4", "state.a // -3", "state.a % MINUS", "state.n % FOUR",
    "2 * (state.a + state.b) * 3", "state.n << 2 >> 1", "state.n << (state.m & 3)",
    "(state.a & 12) == 4", "state.a & (12 == state.b)", "state.a ^ state.b | state.n & 6",
    "state.a - (state.b & 3)", "-(-state.a)", "~(-state.a)", "not not state.a", "-(not state.a)",
    "state.p and state.q and state.a", "state.p or state.q or state.a", "state.a and state.b",
    "(state.a > 3 and state.b) + 1", "(state.p or state.a) * 2",
    "1 if state.a > 3 or state.b > 3 and state.p else 2", "0 < state.a <= state.b < 30",
    "(1 if state.p else 2) if state.q else 3", "1 if state.p else 2 if state.q else 3",
    "1 if (state.p if state.q else state.a > 0) else 5", "max(state.a, state.b, state.n, 3)",
    "min(state.a, max(state.b, -3), 7)", "abs(state.a - state.b)", "state.list[state.n & 3] - 2",
    "state.r[state.n & 1]", "(state.p and state.q or state.a > 2)", "(state.a > 2) == state.p",
    "state.n // 6", "state.a * (state.n // 4)", "state.n // 4 * state.a", "state.n % 4 * 3",
    "state.a * (state.n % 8)", "state.n * 3 // 4", "state.a * (state.b * 3)",
    "state.n // (FOUR // 2)", "state.n - state.n // 4", "(state.n - 1) // 2",
)  # fmt: skip


def drawn(rng, depth):
    """A number that fits 32 bits, as text."""
    if depth == 0:
        return rng.choice(("state.a", "state.b", "state.n", "state.m", "state.p", "state.q",
                           "FOUR", "MINUS", "-3", "5", "state.list[state.n & 3]"))  # fmt: skip
    x, y, z = (drawn(rng, depth - 1) for _ in range(3))
    sign = rng.choice(("<", "<=", ">", ">=", "==", "!="))
    flag = f"({x} {sign} {y})"
    other = rng.choice(("state.p", f"{y} != {z}", f"(not {z})"))
    divisor = rng.choice(("state.n", "state.m", "4", "3", "-5", f"(abs({y}) + 1)"))
    made = rng.choice((
        f"{x} + {y}", f"{x} - {y}", f"{x} * 3", f"2 * {x}", f"{x} // {divisor}", f"{x} % {divisor}",
        f"{x} >> 1", f"(abs({x}) & 63) << 2", f"{x} & {y}", f"{x} | {y}", f"{x} ^ {y}", f"-{x}",
        f"~{x}", f"not {x}", flag, f"{flag} and {other}", f"{flag} or {other}", f"{flag} and {z}",
        f"{flag} or {z}", f"{x} if {flag} else {z}", f"{x} if {z} else {y}",
        f"min({x}, {y}, {z})", f"max({x}, {y})", f"abs({x})", f"{x} {sign} {y} <= {z}",
    ))  # fmt: skip
    return f"({made})"


def role_of(folder, monkeypatch, name, text, **more):
    (folder / f"{name}.py").write_text(text)
    monkeypatch.syspath_prepend(folder)
    return Role("own", name, STATE, (), FRAME, FRAME, {}, **more)


def result_of(expressions):
    """A handler that works out each of these, and calls each function by its timer."""
    lines = [f"    state.r[{i}] = {text}" for i, text in enumerate(expressions)]
    for i, name in enumerate(NAMES, 1):
        lines += [f"    if timer == {i}:", f"        state.r[0] = {name}(state, now)"]
    return BEGIN + "\n".join(lines) + "\n\n" + FUNCTIONS


class State:
    """A state drawn from its ranges."""

    def __init__(self, rng):
        for name, length, low, high, *_ in STATE:
            values = [rng.randint(low, high) for _ in range(max(1, length))]
            setattr(self, name, values if length else values[0])
        self.r = [3, 4] + [0] * (DRAWN + WRITTEN - 2)


def test_c_works_out_what_python_does(tmp_path, monkeypatch):
    if shutil.which("gcc") is None:
        pytest.skip("gcc is not installed")
    rng = random.Random("expressions")
    texts = [*HAND, *(drawn(rng, 3) for _ in range(DRAWN + WRITTEN - len(HAND)))]
    made = Library(role_of(tmp_path, monkeypatch, "own_made", result_of(texts)), {})
    (tmp_path / "own.h").write_text(made.header())
    (tmp_path / "own.c").write_text(made.source("own.h"))
    run(["gcc", "-std=c99", "-w", "-O0", "-fPIC", "-shared", tmp_path / "own.c", "-o",
         tmp_path / "own.so"])  # fmt: skip
    native, packed = ctypes.CDLL(str(tmp_path / "own.so")), Packed(made.records["state"])
    plain, out = importlib.import_module("own_made"), ctypes.create_string_buffer(4096)
    for call in range(CALLS):
        state, timer = State(rng), call % (len(NAMES) + 1)
        place = ctypes.create_string_buffer(packed.of(state), packed.size)
        native.own_on_timer(place, out, call, timer, out)
        plain.on_timer(state, None, call, timer, None)
        state.r = [int(one or 0) for one in state.r]
        given = packed.of(state)
        assert packed.differences(given, place.raw) == [], (call, timer, texts)


HELPERS = '''

def counts(state):
    """Doc."""
    state.a = state.a + 1
    return state.a


def looks(state):
    """Doc."""
    return state.a


def sets(state):
    """Doc."""
    state.b = 3
    return 1


def nothing(state):
    """Doc."""
    state.a = 1


def values(state):
    """Doc."""
    return state.list


def both(state):
    """Doc."""
    if state.p:
        return state.a
    return


def two(state, out):
    """Doc."""
    if state.p:
        return 1
    return state
'''
ORDER = "one part changes what another reads: give it a line of its own"
REFUSED = {
    "state.r[0] = counts(state) + looks(state)": ORDER,
    "state.r[0] = looks(state) + counts(state)": ORDER,
    "state.r[0] = counts(state) + state.a": ORDER,
    "state.r[0] = state.a - counts(state)": ORDER,
    "state.r[0] = counts(state) * counts(state)": ORDER,
    "state.r[0] = max(counts(state), 3, state.a)": ORDER,
    "state.r[0] = sets(state) + sets(state)": ORDER,
    "state.r[0] = state.a < counts(state)": ORDER,
    "state.r[0] = 1 < sets(state) < 3": "a chain of comparisons with a call that changes things",
    "state.r[0] = now or timer": "`or` of what is not 0 or 1 is not in the dialect",
    "state.r[0] = state.p or now or timer": "`or` of what is not 0 or 1 is not in the dialect",
    "while now:\n    pass\nelse:\n    pass": "a while with an else",
    "for i in range(3):\n    pass\nelse:\n    pass": "a for with an else",
    "for i in range(0, 9, 2):\n    pass": "no range of one or two",
    "for i in range():\n    pass": "no range of one or two",
    "for i in max(1, 2):\n    pass": "no range of one or two",
    "state.a": "a value that nobody uses",
    "a = nothing(state)": "returns nothing",
    "state.a = values(state)": "an array is returned",
    "state.a = two(state, out)": "it returns two different things",
    "state.a = looks(state, now)": "looks takes 1 arguments",
    "state.a = looks()": "looks takes 1 arguments",
    "state.a = 2147483648": "no whole number of 32 bits",
    "state.a = now / 2": "div is not in the dialect",
    "state.a = now @ 2": "is not in the dialect",
    "state.a = now is timer": "`in` and `is`",
    "state.a = state.list[0:1]": "no number",
    "state.a = state.list[state]": "no number",
    "state.a = max(*state.list)": "starred argument",
    "state.a = looks(state=state)": "a keyword or starred argument",
    "state.a = state.looks()": "calls something that is no name",
    "state.list[0] = state.list": "only numbers are assigned",
    "state.list = 3": "only numbers",
    "a = 1\na = state": "a is two different things",
    "state.a = state.zz": "no such field",
    "state.a = state + 1": "state is no number",
    "state.a = 1 if state else 2": "is no number",
    "state.a = not state": "is no number",
    "state.a = state < 1": "is no number",
    "state.a = unknown + 1": "is no constant and was given no value",
    "del state.a": "delete is not in the dialect",
}
TAKEN = (
    "state.a = both(state)", "state.r[0] = counts(state) + state.b", "sets(state)",
    "state.r[0] = sets(state) + looks(state)", "state.a = 2147483647", "state.a = -2147483647",
    "state.r[0] = 1 < looks(state) < 3", "state.r[0] = state.p or now < 3 or timer",
    "state.r[0] = state.a + looks(state)",
)  # fmt: skip


def of_body(tmp_path, monkeypatch, body):
    name = f"own_{[*REFUSED, *TAKEN].index(body)}"
    lines = "".join(f"    {line}\n" for line in body.splitlines())
    return Library(role_of(tmp_path, monkeypatch, name, BEGIN + lines + HELPERS), {})


@pytest.mark.parametrize("body", REFUSED)
def test_what_c_could_not_say_alike_is_refused_with_why(tmp_path, monkeypatch, body):
    with pytest.raises(Refused) as refused:
        of_body(tmp_path, monkeypatch, body)
    assert REFUSED[body] in str(refused.value)


@pytest.mark.parametrize("body", TAKEN)
def test_what_c_can_say_alike_is_taken(tmp_path, monkeypatch, body):
    assert "own_on_timer" in of_body(tmp_path, monkeypatch, body).source("own.h")


LOOKS = '''"""Doc."""

from {other} import on_input


def on_frame(state, params, now, port, frame, out):
    """Doc."""
    state.a = look(frame) + on_input(state)


def look(record):
    """Doc."""
    return record.x
'''


def test_what_is_made_for_two_kinds_of_records_is_called_after_them(tmp_path, monkeypatch):
    text = LOOKS.replace("from {other} import on_input\n\n\n", "").replace(" + on_input(state)", "")
    text += '\n\ndef on_input(state, params, now, kind, item, out):\n    """Doc."""\n'
    role = role_of(tmp_path, monkeypatch, "own_kinds", text + "    state.b = look(item)\n")
    source = Library(role._replace(item=FRAME[:1]), {}).source("own.h")
    assert "own_look_frame(const own_frame_t *record)" in source
    assert "own_look_item(const own_item_t *record)" in source
    assert "own_look_item(item);" in source


def test_handlers_are_those_of_the_module_itself(tmp_path, monkeypatch):
    """What it calls may have such a name, too."""
    (tmp_path / "own_other.py").write_text(
        '"""Doc."""\n\n\ndef on_input(state):\n    """Doc."""\n    return state.a\n'
    )
    role = role_of(tmp_path, monkeypatch, "own_calls", LOOKS.format(other="own_other"))
    made = Library(role, {})
    assert [one.name for one in made.program.handlers] == ["on_frame"]
    assert "static int32_t own_on_input(const own_state_t *state)" in made.source("own.h")


def test_functions_that_call_themselves_and_handlers_of_other_arguments_are_refused(
    tmp_path, monkeypatch
):
    text = BEGIN + "    one(state)\n"
    for one, other in (("one", "two"), ("two", "one")):
        text += f'\n\ndef {one}(state):\n    """Doc."""\n    {other}(state)\n'
    for name, body, why in (
        ("own_round", text, "one calls itself"),
        ("own_few", BEGIN.replace(", out", "") + "    pass\n", "takes 5 arguments, not 4"),
        ("own_many", BEGIN.replace("out)", "out, z)") + "    pass\n", "takes 5 arguments, not 6"),
    ):
        with pytest.raises(Refused, match=why):
            Library(role_of(tmp_path, monkeypatch, name, body), {})
