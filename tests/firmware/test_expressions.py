"""Expressions and statements that no protocol has (yet), in C and in Python: they do the same."""

import ctypes
import importlib
import random
import shutil

import pytest

from boards.firmware.native import run
from innervate.firmware.emit import Library
from innervate.firmware.packed import Packed
from innervate.live.board import Role

DRAWN, WRITTEN, CALLS = 90, 50, 400
NUMBER = (-(1 << 31), (1 << 31) - 1, "number", "")
STATE = (
    ("a", 0, -40, 40, "number", ""), ("b", 0, -40, 40, "number", ""),
    ("n", 0, 1, 40, "number", ""), ("m", 0, 1, 40, "number", ""),
    ("p", 0, 0, 1, "flag", ""), ("q", 0, 0, 1, "flag", ""), ("byte", 0, 0, 255, "number", ""),
    ("half", 0, -32768, 32767, "number", ""), ("list", 4, 0, 9, "number", ""),
    ("five", 0, 5, 5, "number", ""), ("less", 0, -2, -2, "number", ""),
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


def asked_once(state, now):
    """Doc."""
    found = 0
    for i in range(bump(state.list, 1)):
        found += i + 1
    return found * 10 + state.list[1]


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
        if state.n > 20:
            return found - 100
    else:
        return found + 100
'''
NAMES = ("early", "last", "counted", "set_inside", "grows", "while_", "narrow", "passes",
         "asked_once", "twins", "unused", "either")  # fmt: skip
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
    "state.five * state.a - state.less", "state.n // state.five", "-state.less % state.five",
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


def test_what_has_but_one_value_is_a_number_in_c(tmp_path, monkeypatch):
    """Nothing else is asked of `params` then: compilers are told that it is meant."""
    lines = ("state.five = 5", "for _ in range(state.five):", "    state.a = state.less",
             "state.b = params.seven", "state.n = frame.x")  # fmt: skip
    text = BEGIN.replace("timer", "frame") + "".join(f"    {line}\n" for line in lines)
    text = text.replace("now, frame", "now, port, frame")
    role = role_of(tmp_path, monkeypatch, "own_only", text)
    role = role._replace(params=(("seven", 0, 7, 7, "number", ""),))
    source = Library(role, {}).source()
    body = [line.strip() for line in source[source.rindex("{\n    (void)") :].splitlines()]
    assert body == [
        "{", "(void)params;", "(void)now;", "(void)port;", "(void)out;", "state->five = 5;",
        "for (int32_t turn_ = 0; turn_ < 5; turn_++) {", "state->a = -2;", "}",
        "state->b = (int8_t)7;", "state->n = (uint8_t)frame->x;", "}",
    ]  # fmt: skip


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
    (tmp_path / "own.c").write_text(made.source())
    run(["gcc", "-std=c99", "-Werror=discarded-qualifiers", "-O0", "-fPIC", "-shared",
         tmp_path / "own.c", "-o", tmp_path / "own.so"])  # fmt: skip
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
