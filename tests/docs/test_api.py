"""docs/api.md: its code runs in order, and every public name stands on it."""

import inspect
import pkgutil
import re
from pathlib import Path

import pytest

import innervate

PAGE = Path(__file__).resolve().parents[2] / "docs" / "api.md"
TEXT = PAGE.read_text(encoding="utf-8")


def test_the_code_runs_in_order(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    names = {"__file__": str(PAGE)}
    for code in re.findall(r"```python\n(.*?)```", TEXT, re.DOTALL):
        exec(compile(code, str(PAGE), "exec"), names)
    assert names["found"].results["protocol.k"].to_list() == [3, 3, 7, 7]


@pytest.mark.parametrize("name", sorted(set(innervate.__all__) - {"__version__"}))
def test_every_name_stands_where_it_is_described(name):
    (place,) = re.findall(rf"^::: (innervate\.\S*\.{name})$", TEXT, re.MULTILINE)
    assert pkgutil.resolve_name(place) is getattr(innervate, name)


@pytest.mark.parametrize("name", sorted(set(innervate.__all__) - {"__version__"}))
def test_descriptions_are_shown_as_they_are_written(name):
    """A word in <> would be a tag of the page, and of "a, b: words" only b a name."""
    found = getattr(innervate, name)
    members = vars(found).values() if inspect.isclass(found) else ()
    for text in filter(None, (inspect.getdoc(one) for one in (found, *members))):
        assert not re.search(r"<[a-z]", text), text
        assert not re.search(r"^ +\w+, \w+: ", text, re.MULTILINE), text
