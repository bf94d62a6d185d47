"""On which line a key stands, behind texts of all forms that TOML has."""

import tomllib

import pytest

from innervate.scenario.lines import key_lines

STRINGS = [
    '""', "''", '""""""', "''''''", '"a"', "'a'", '"""a"""', "'''a'''", r'"a\""', r'"\\"',
    r'"""\""""', '""""a"""', '"""a"b""c"""', '"""a""""', '"""a"""""', "''''a'''", "'''a''b'''",
    "'''a''''", "'\\'", '"#"', "'#'", '"[x]"', "'y = 1'", '"""\n"""', "'''\n\n'''",
    '"""a\n# b = 1"""',
    '"""\n[t]\nz = 3"""', '"""\\\n   a"""', r'"\u0041"', '"""a\\"""b"""',
]  # fmt: skip


@pytest.mark.parametrize("form", [
    "a = {}\nb = 1\n", "a = [{}, 2]\nb = 1\n", "a = {{ c = {}, d = 4 }}\nb = 1\n",
    "a = [{}]\nb = 1\n", "a = {{ c = {}}}\nb = 1\n", "[t]\na = {}#x = 1\n[u]\nb = 1\n",
    "a = [\n  {},\n  {},\n]\nb = 1\n",
])  # fmt: skip
def test_a_key_behind_a_text_is_found_on_its_line(form):
    for text in STRINGS:
        whole = form.format(text, text)
        read = tomllib.loads(whole)
        found = key_lines(whole)
        behind = ("u", "b") if "u" in read else ("b",)
        before = whole[: whole.index("b = 1\n", whole.rindex("\nb"))]
        assert found[behind] == before.count("\n") + 1, text
        (a,) = [key for key in found if key[-1:] == ("a",)]
        assert found[a] == (2 if "t" in read and "u" in read else 1), text
        if "c = " in form and "d" in read["a"]:
            assert found["a", "d"] == whole[: whole.index("d = 4")].count("\n") + 1, text


KEYS = ["a", '"a"', "'a'", '"a b"', "'#'", '""', "a-b_9", r'"\u0041"', 'x."y.z".w', "x . y"]


@pytest.mark.parametrize("key", KEYS)
def test_keys_are_found_as_tomllib_reads_them(key):
    whole = f"# first\n\n{key} = 1\n[[t]]\n{key} = 2\n[[t]]\n{key} = 3\n"
    read, path = tomllib.loads(whole), ()
    inner = read
    while isinstance(inner, dict):
        name = next(one for one in inner if one != "t" or len(inner) == 1)
        path, inner = (*path, name), inner[name]
    found = key_lines(whole)
    assert found[path] == 3
    assert [found["t", i, *path] for i in (0, 1)] == [5, 7]
