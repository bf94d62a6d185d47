"""What a protocol looks like as C: the parentheses that it needs and no others, line by line."""

import re
from types import SimpleNamespace

import pytest

from innervate.firmware.constants import names_of
from innervate.firmware.emit import Library
from innervate.firmware.errors import FirmwareError
from tests.firmware.test_expressions import BEGIN, role_of

# Of a number, a flag or a list of the state, without the words that say so.
EXPRESSIONS = (
    ("a - (b - n)", "a - (b - n)"), ("a - b - n", "a - b - n"), ("a - -b", "a - -b"),
    ("n // 4 // 2", "(n / 4) / 2"),
    ("n // (m // 8 + 1)", "(int32_t)((uint32_t)n / (uint32_t)(m / 8 + 1))"),
    ("n % m % 3", "(int32_t)((uint32_t)(int32_t)((uint32_t)n % (uint32_t)m) % 3)"),
    ("a // 4", "own_floor_div(a, 4)"), ("a % 4", "own_floor_mod(a, 4)"),
    ("a // -3", "own_floor_div(a, -3)"), ("a % MINUS", "own_floor_mod(a, OWN_MINUS)"),
    ("n % FOUR", "(int32_t)((uint32_t)n % OWN_FOUR)"), ("2 * (a + b) * 3", "2 * (a + b) * 3"),
    ("n << 2 >> 1", "(n << 2) >> 1"), ("n << (m & 3)", "n << (m & 3)"),
    ("(a & 12) == 4", "(a & 12) == 4"), ("a & (12 == b)", "a & (12 == b)"),
    ("a ^ b | n & 6", "(a ^ b) | (n & 6)"), ("a - (b & 3)", "a - (b & 3)"), ("-(-a)", "-(-a)"),
    ("~(-a)", "~(-a)"), ("not not a", "!(!a)"), ("-(not a)", "-(!a)"),
    ("p and q and a", "(p && q) ? a : 0"), ("p or q or a", "(p || q) ? 1 : a"),
    ("a and b", "a ? b : 0"), ("(a > 3 and b) + 1", "(a > 3 ? b : 0) + 1"),
    ("(p or a) * 2", "(p ? 1 : a) * 2"),
    ("1 if a > 3 or b > 3 and p else 2", "(a > 3 || (b > 3 && p)) ? 1 : 2"),
    ("0 < a <= b < 30", "0 < a && a <= b && b < 30"),
    ("(1 if p else 2) if q else 3", "q ? (p ? 1 : 2) : 3"),
    ("1 if p else 2 if q else 3", "p ? 1 : (q ? 2 : 3)"),
    ("1 if (p if q else a > 0) else 5", "(q ? p : a > 0) ? 1 : 5"),
    ("max(a, b, n, 3)", "own_max(own_max(own_max(a, b), n), 3)"),
    ("min(a, max(b, -3), 7)", "own_min(own_min(a, own_max(b, -3)), 7)"),
    ("abs(a - b)", "own_abs(a - b)"), ("list[n & 3] - 2", "list[n & 3] - 2"),
    ("(p and q or a > 2)", "(p && q) || a > 2"), ("(a > 2) == p", "(a > 2) == p"),
    ("n // 6", "(int32_t)((uint32_t)n / 6)"), ("n // 4 * a", "n / 4 * a"),
    ("n % 4 * 3", "n % 4 * 3"), ("a * (n % 8)", "a * (n % 8)"), ("n * 3 // 4", "(n * 3) / 4"),
    ("a * (b * 3)", "a * (b * 3)"),
    ("n // (FOUR // 2)", "(int32_t)((uint32_t)n / (uint32_t)(OWN_FOUR / 2))"),
    ("n - n // 4", "n - n / 4"), ("(n - 1) // 2", "own_floor_div(n - 1, 2)"),
    ("n // m", "(int32_t)((uint32_t)n / (uint32_t)m)"), ("n // 0x4", "n / 4"), ("n % 8", "n % 8"),
    ("n % 7", "(int32_t)((uint32_t)n % 7)"), ("n + (2 if p else 3)", "n + (p ? 2 : 3)"),
    ("abs(-3)", "own_abs(-3)"), ("(p or q) and b", "(p || q) ? b : 0"), ("a * b * 2", "a * b * 2"),
    ("1 if (a and b) else 2", "(a && b) ? 1 : 2"), ("(a > 3) + 1", "(a > 3) + 1"),
    ("a + 1 > 3", "a + 1 > 3"), ("a << 1 < 4", "(a << 1) < 4"), ("n ^ 1 ^ 2", "n ^ 1 ^ 2"),
    ("n & 1 | 2", "(n & 1) | 2"), ("n & (1 & m)", "n & (1 & m)"),
    ("n - 1 - (2 - 3)", "n - 1 - (2 - 3)"),
    # C divides as Python does what is never negative; `and` of what is 0 or 1 alone is its `&&`.
    ("(a & n) // 4", "(a & n) / 4"), ("(a | n) // 4", "own_floor_div(a | n, 4)"),
    ("(p ^ n) // 4", "(p ^ n) / 4"), ("(n + m) // 4", "(n + m) / 4"),
    ("(n + a) // 4", "own_floor_div(n + a, 4)"), ("(n - m) // 4", "own_floor_div(n - m, 4)"),
    ("(n * m) // 4", "(n * m) / 4"), ("(n * a) // 4", "own_floor_div(n * a, 4)"),
    ("(n << 2) // 4", "(n << 2) / 4"), ("(n >> 1) // 4", "(n >> 1) / 4"),
    ("(a >> 1) // 4", "own_floor_div(a >> 1, 4)"), ("(a % n) // 4", "own_floor_mod(a, n) / 4"),
    ("(n % a) // 4", "own_floor_div(own_floor_mod(n, a), 4)"),
    ("(n // m) // 4", "(int32_t)((uint32_t)n / (uint32_t)m) / 4"),
    ("max(n, m) // 4", "own_max(n, m) / 4"), ("max(a, n) // 4", "own_max(a, n) / 4"),
    ("min(n, m) // 4", "own_min(n, m) / 4"), ("min(n, a) // 4", "own_floor_div(own_min(n, a), 4)"),
    ("abs(a) // 4", "own_abs(a) / 4"), ("(n if p else m) // 4", "(p ? n : m) / 4"),
    ("(n if p else a) // 4", "own_floor_div(p ? n : a, 4)"), ("(p and n) // 4", "(p ? n : 0) / 4"),
    ("(p and a) // 4", "own_floor_div(p ? a : 0, 4)"), ("(p or n) // 4", "(p ? 1 : n) / 4"),
    ("(p or a) // 4", "own_floor_div(p ? 1 : a, 4)"), ("(not a) // 4", "!a / 4"),
    ("(-n) // 4", "own_floor_div(-n, 4)"), ("(~n) // 4", "own_floor_div(~n, 4)"),
    ("(a < b) // 4", "(a < b) / 4"), ("now // 4", "now / 4"), ("timer // 4", "timer / 4"),
    ("list[0] // 4", "list[0] / 4"), ("7 // 4", "7 / 4"), ("(-7) // 4", "own_floor_div(-7, 4)"),
    ("True // 4", "1 / 4"), ("(p & n) and p", "p & n && p"), ("(n & m) and p", "n & m ? p : 0"),
    ("(p | q) and p", "p | q && p"), ("(p | n) and p", "p | n ? p : 0"),
    ("(p ^ q) and p", "p ^ q && p"), ("(p * q) and p", "p * q && p"),
    ("(p * n) and p", "p * n ? p : 0"), ("(p + q) and p", "p + q ? p : 0"),
    ("(p >> 1) and p", "p >> 1 && p"), ("(n % 2) and p", "n % 2 ? p : 0"),
    ("min(p, q) and p", "own_min(p, q) && p"), ("min(p, n) and p", "own_min(p, n) ? p : 0"),
    ("max(p, q) and p", "own_max(p, q) && p"), ("max(p, 2) and p", "own_max(p, 2) ? p : 0"),
    ("(not n) and p", "!n && p"), ("(p if q else 1) and p", "(q ? p : 1) && p"),
    ("(p if q else 2) and p", "(q ? p : 2) ? p : 0"), ("abs(p) and p", "own_abs(p) ? p : 0"),
    ("(p and q) and p", "(p && q) && p"), ("(a > b) and p", "a > b && p"), ("1 and p", "1 && p"),
    ("2 and p", "2 ? p : 0"), ("now and p", "now ? p : 0"), ("timer and p", "timer ? p : 0"),
    ("byte and p", "byte ? p : 0"),
    ("(n - m) and p", "n - m ? p : 0"), ("(~p) and p", "~p ? p : 0"),
    ("out.action[3].b - 1", "(&out->action[3])->b - 1"), ("n << 2 << 1", "(n << 2) << 1"),
    ("not (p and q and n)", "!(p && q && n)"), ("(p or n) if q else 3", "q ? (p ? 1 : n) : 3"),
    ("(p and n) if q else 3", "q ? (p ? n : 0) : 3"),
    ("n and (1 if p else 2)", "n ? (p ? 1 : 2) : 0"), ("0 < n < 3 or p", "(0 < n && n < 3) || p"),
    ("p or 0 < n < 3", "p || (0 < n && n < 3)"), ("(p or now) + 1", "(p ? 1 : now) + 1"),
)  # fmt: skip
FIELDS = ("list", "a", "b", "n", "m", "p", "q", "byte")
STATEMENTS = '''"""Doc."""

MOST = 9

def on_timer(state, params, now, timer, out):
    """Doc."""
    # Before all else; a comment that ends with */, of two lines here, and of two lines there,
    # where none is longer than a hundred columns: its first word behind them opens another.
    state.byte = 3  # a constant is not narrowed
    state.byte = -MOST
    state.byte = state.half
    state.half = state.half  # of one type
    state.list[1] = state.half = state.byte = state.a


    state.list[0] = state.list[1]
    state.byte += state.n
    state.half = now + timer
    state.n = now
    none(state)
    maybe(state)
    falls(state, 3)
    if state.p:  # behind the test
        return
    elif state.q:
        pass
    else:
        # In the last branch.
        state.n = 4
    if not state.p and state.q:
        state.n = 5
    if state.a:
        state.n = 6
    else:
        # An `if` of its own.
        found = state.a
        if found:
            state.n = found
    while state.n > 3 or state.a:
        state.n -= 1
        if state.n == 7:
            continue
        break


def none(state):
    """Doc."""
    if state.a:
        return
    state.a = 1


def maybe(state):
    """Doc."""
    if state.a:
        return
    if state.b:
        return 4


def falls(state, count):
    """Doc."""
    if count:
        return 3
    for _ in range(state.n):
        state.a = 1
    for i in range(2, count):
        state.a = i
    for k in range(count):
        count = 7
    for at in range(abs(count)):
        at = at + state.b
    return left(state, count)


def left(state, count):
    """Doc."""
    where = 3
    for where in range(MOST):
        if state.list[where & 3] == where:
            break
    total = where
    total += 2
    total //= 2
    if count > 5 and state.a > 100 and state.b > 100 and state.n > 100 and state.m > 100 and where:
        total = max(total, where, count, state.a, state.b, state.n, state.m, state.byte, state.half)
    return total
'''
IN_C = """\
/* Doc.
 * own_lines.py:46 */
static void own_none(own_state_t *state)
{
    if (state->a) {
        return;
    }
    state->a = 1;
}

/* Doc.
 * own_lines.py:53 */
static int32_t own_maybe(const own_state_t *state)
{
    if (state->a) {
        return 0;
    }
    if (state->b) {
        return 4;
    }
    return 0;
}

/* Doc.
 * own_lines.py:76 */
static int32_t own_left(const own_state_t *state, int32_t count)
{
    int32_t where = 3;
    for (int32_t next_where = 0; next_where < OWN_MOST; next_where++) {
        where = next_where;
        if (state->list[where & 3] == where) {
            break;
        }
    }
    int32_t total = where;
    total = total + 2;
    total = total / 2;
    if (count > 5 && state->a > 100 && state->b > 100 && state->n > 100 && state->m > 100 &&
            where) {
        total = own_max(own_max(own_max(own_max(own_max(own_max(own_max(own_max(total, where),
                count), state->a), state->b), state->n), state->m), state->byte), state->half);
    }
    return total;
}

/* Doc.
 * own_lines.py:61 */
static int32_t own_falls(own_state_t *state, int32_t count)
{
    if (count) {
        return 3;
    }
    const int32_t turn_end_65 = state->n;
    for (int32_t turn_ = 0; turn_ < turn_end_65; turn_++) {
        state->a = 1;
    }
    for (int32_t i = 2; i < count; i++) {
        state->a = (int8_t)i;
    }
    const int32_t k_end_69 = count;
    for (int32_t k = 0; k < k_end_69; k++) {
        count = 7;
    }
    const int32_t at_end_71 = own_abs(count);
    for (int32_t next_at = 0; next_at < at_end_71; next_at++) {
        int32_t at = next_at;
        at = at + state->b;
    }
    return own_left(state, count);
}

/* Doc.
 * own_lines.py:5 */
void own_on_timer(own_state_t *state, const own_params_t *params, int32_t now, int32_t timer,
        own_out_t *out)
{
    (void)params;
    (void)out;
    /* Before all else; a comment that ends with * /, of two lines here, and of two lines there,
     * where none is longer than a hundred columns: its first word behind them opens another. */
    state->byte = 3; /* a constant is not narrowed */
    state->byte = -OWN_MOST;
    state->byte = (uint8_t)state->half;
    state->half = state->half; /* of one type */
    state->list[1] = (uint8_t)state->a;
    state->half = (int16_t)state->a;
    state->byte = (uint8_t)state->a;
    state->list[0] = state->list[1];
    state->byte = (uint8_t)(state->byte + state->n);
    state->half = (int16_t)(now + timer);
    state->n = (uint8_t)now;
    own_none(state);
    (void)own_maybe(state);
    (void)own_falls(state, 3);
    if (state->p) { /* behind the test */
        return;
    } else if (state->q) {
        ;
    } else {
        /* In the last branch. */
        state->n = 4;
    }
    if (!state->p && state->q) {
        state->n = 5;
    }
    if (state->a) {
        state->n = 6;
    } else {
        /* An `if` of its own. */
        int32_t found = state->a;
        if (found) {
            state->n = (uint8_t)found;
        }
    }
    while (state->n > 3 || state->a) {
        state->n = (uint8_t)(state->n - 1);
        if (state->n == 7) {
            continue;
        }
        break;
    }
}
"""


def of_state(text, arrow):
    """The text with every field as one of the state."""
    return re.sub(rf"(?<![.>])\b({'|'.join(FIELDS)})\b", rf"state{arrow}\1", text)


def made(tmp_path, monkeypatch, name, text):
    """The C behind what every protocol has."""
    source = Library(role_of(tmp_path, monkeypatch, name, text), {}).source()
    return source[source.index("/* Doc.") :]


def test_an_expression_has_the_parentheses_that_it_needs(tmp_path, monkeypatch):
    lines = [f"    state.r[{i}] = {of_state(text, '.')}" for i, (text, _) in enumerate(EXPRESSIONS)]
    shown = made(tmp_path, monkeypatch, "own_text", BEGIN + "\n".join(lines) + "\n")
    found = re.findall(r"  state->r\[\d+\] = (.*);", shown)
    assert found == [of_state(text, "->") for _, text in EXPRESSIONS]


def test_statements_and_their_comments_stand_as_they_stood(tmp_path, monkeypatch):
    assert made(tmp_path, monkeypatch, "own_lines", STATEMENTS) == IN_C


def test_constants_of_two_values_are_called_after_their_modules():
    def names(*known):
        functions = (SimpleNamespace(module=module, constants=numbers) for module, numbers in known)
        return names_of(functions, "own")

    found = names(("ring.go", {"ONE": 1, "kinds.DATA": 5, "kinds.ACK": 6, "timers.ACK": 0}),
                  ("ring.come", {"ONE": 2, "kinds.DATA": 5}))  # fmt: skip
    assert found == {
        "": "own", "ring.go.ONE": "OWN_GO_ONE", "ring.come.ONE": "OWN_COME_ONE",
        "ring.go.kinds.DATA": "OWN_DATA", "ring.come.kinds.DATA": "OWN_DATA",
        "ring.go.kinds.ACK": "OWN_KINDS_ACK", "ring.go.timers.ACK": "OWN_TIMERS_ACK",
    }  # fmt: skip
    with pytest.raises(FirmwareError, match="another constant is called KINDS_ACK in C, too"):
        names(("ring.go", {"kinds.ACK": 6}), ("ring.come", {"kinds.ACK": 7}))
