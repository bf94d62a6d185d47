"""Options by name: shown by `help`, and a misspelt one is refused, with those that there are."""

from inspect import Parameter, signature

import pytest

import innervate
from innervate.sweeping import make_plan

CALLS = {
    "run takes no plian; it takes checks, received, plain":
        lambda: innervate.run("line", plian=True),
    "a sweep takes no repaet, workrs; it takes vary, ":
        lambda: innervate.sweep("line", repaet=2, workrs=1),
    "a sweep takes no workrs": lambda: innervate.sweep(make_plan("line"), workrs=1),
    "a sweep takes no workers; it takes vary, ": lambda: make_plan("line", workers=1),
    "size takes no vary; it takes workers, kind, dask":
        lambda: innervate.size(innervate.Question("none", "*"), vary=()),
}  # fmt: skip


@pytest.mark.parametrize(
    ("function", "shown"),
    [
        (innervate.run, {"checks": True, "received": None, "plain": False, "seed": None}),
        (innervate.sweep, {"vary": (), "repeat": None, "workers": None, "kind": "processes"}),
        (innervate.size, {"repeat": 20, "workers": None, "dask": ""}),
        (innervate.explore, {"reduce": True, "plain": False}),
        (make_plan, {"vary": (), "until": ()}),
    ],
)
def test_help_shows_options_and_what_is_usual(function, shown):
    found = signature(function).parameters
    assert {name: found[name].default for name in shown} == shown
    assert all(one.kind is not Parameter.VAR_KEYWORD for one in found.values())


@pytest.mark.parametrize("said", CALLS)
def test_what_a_function_does_not_take_is_refused(said):
    with pytest.raises(TypeError, match=said):
        CALLS[said]()
