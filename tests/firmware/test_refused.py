"""What C could not say as Python does is refused, with why; and how C calls what it makes."""

import pytest

from innervate.firmware.emit import Library
from innervate.firmware.errors import Refused
from tests.firmware.test_expressions import BEGIN, FRAME, role_of

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


def through(state):
    """Doc."""
    values = state.list
    values[0] = 1
    return 1


def bump(values, at):
    """Doc."""
    values[at] = values[at] + 1
    return values[at]


def bumps(state):
    """Doc."""
    values = state.list
    return bump(values, 0)


def counted(state):
    """Doc."""
    return counts(state)


def looked(state):
    """Doc."""
    return looks(state)


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
    "state.r[0] = counted(state) + state.a": ORDER,
    "state.r[0] = looked(state) + counted(state)": ORDER,
    "state.r[0] = state.a - counts(state)": ORDER,
    "state.r[0] = counts(state) * counts(state)": ORDER,
    "state.r[0] = max(counts(state), 3, state.a)": ORDER,
    "state.r[0] = sets(state) + sets(state)": ORDER,
    "state.r[0] = through(state) + state.list[0]": ORDER,
    "state.r[0] = bump(state.list, 0) + state.list[0]": ORDER,
    "state.r[0] = state.list[0] + bump(state.list, 0)": ORDER,
    "values = state.list\nstate.r[0] = bump(values, 0) + state.list[0]": ORDER,
    "values = state.list\nstate.r[0] = bump(state.list, 0) + values[0]": ORDER,
    "state.r[0] = bumps(state) + state.list[0]": ORDER,
    "state.r[0] = state.a < counts(state)": ORDER,
    "state.list[counts(state)] = state.a": ORDER,
    "state.list[counts(state)] = counts(state)": ORDER,
    "state.list[state.a] = counts(state)": ORDER,
    "state.list[state.a] += counts(state)": ORDER,
    "state.list[counts(state)] += 1": "an index that changes things stands in C twice",
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
    "state.a += state.list": "state.list is no number",
    "state.a += nothing(state)": "nothing(state) is no number",
    "state.a /= 2": "div is not in the dialect",
    "a += 1": "is no constant and was given no value",
    "state.a = state < 1": "is no number",
    "state.a = unknown + 1": "is no constant and was given no value",
    "if now:\n    a = 1\nstate.a = a": ":10: a has no value here on some way",
    "if now:\n    a = 1\nelif timer:\n    b = 2\nelse:\n    a = 3\nstate.a = a": ":14: a has no",
    "for i in range(now):\n    a = i\nstate.a = a": ":10: a has no value here",
    "for i in range(now):\n    pass\nstate.a = i": ":10: i has no value here",
    "for i in range(3):\n    if now:\n        a = 1\n    state.a = a": ":11: a has no value here",
    "while now:\n    a = 1\n    break\nstate.a = a": ":11: a has no value here",
    "if now:\n    a = 1\na += 1": ":10: a has no value here",
    "while True:\n    if now:\n        break\n    a = 1\nstate.a = a": ":12: a has no value here",
    "state.a = FOUR\nFOUR = 3": ":8: FOUR has no value here",
    "del state.a": "delete is not in the dialect",
}
TAKEN = (
    "state.a = both(state)", "state.r[0] = counts(state) + state.b", "sets(state)",
    "state.r[0] = sets(state) + looks(state)", "state.a = 2147483647", "state.a = -2147483647",
    "state.r[0] = 1 < looks(state) < 3", "state.r[0] = state.p or now < 3 or timer",
    "state.r[0] = state.a + looks(state)", "state.r[0] = bump(state.list, 0) + state.a",
    "state.r[0] = bumps(state) + looks(state)", "state.list[now] = counts(state)",
    "state.list[counts(state)] = now", "state.a += looks(state)", "state.a = counts(state)",
    "state.list[looks(state)] += 1", "if now:\n    a = 1\nelse:\n    a = 2\nstate.a = a",
    "if now:\n    return\nelse:\n    a = 2\nstate.a = a",
    "for i in range(now):\n    if timer:\n        continue\n    a = i\n    state.a = a",
    "while True:\n    a = 1\n    if now:\n        break\nstate.a = a",
    "a = 1\nif now:\n    a += 1\nwhile now < a:\n    a = a - 1\nstate.a = a",
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
    assert "own_on_timer" in of_body(tmp_path, monkeypatch, body).source()


@pytest.mark.parametrize(("name", "takes"), [
    ("looks", "const own_state_t *state"), ("through", "own_state_t *state"),
    ("bumps", "own_state_t *state"), ("bump", "uint8_t *values, int32_t at"),
])  # fmt: skip
def test_who_changes_what_it_is_given_says_so(tmp_path, monkeypatch, name, takes):
    call = f"{name}(state.list, 0)" if name == "bump" else f"{name}(state)"
    text = f"{BEGIN}    state.r[0] = {call}\n{HELPERS}"
    made = Library(role_of(tmp_path, monkeypatch, f"own_gives_{name}", text), {})
    assert f" own_{name}({takes})" in made.source()


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
    source = Library(role._replace(item=FRAME[:1]), {}).source()
    assert "own_look_frame(const own_frame_t *record)" in source
    assert "own_look_item(const own_item_t *record)" in source
    assert "own_look_item(item);" in source


def test_a_function_of_its_own_goes_before_one_of_pythons(tmp_path, monkeypatch):
    text = BEGIN + '    state.b = max(state)\n\n\ndef max(state):\n    """Doc."""\n'
    role = role_of(tmp_path, monkeypatch, "own_max", text + "    return state.a\n")
    assert "own_max(const own_state_t *state)" in Library(role, {}).source()


def test_handlers_are_those_of_the_module_itself(tmp_path, monkeypatch):
    """What it calls may have such a name, too."""
    (tmp_path / "own_other.py").write_text(
        '"""Doc."""\n\n\ndef on_input(state):\n    """Doc."""\n    return state.a\n'
    )
    role = role_of(tmp_path, monkeypatch, "own_calls", LOOKS.format(other="own_other"))
    made = Library(role, {})
    assert [one.name for one in made.program.handlers] == ["on_frame"]
    assert "static int32_t own_on_input(const own_state_t *state)" in made.source()


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
