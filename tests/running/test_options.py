"""A misspelt argument of a public function is refused, with the names that there are."""

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


@pytest.mark.parametrize("said", CALLS)
def test_what_a_function_does_not_take_is_refused(said):
    with pytest.raises(TypeError, match=said):
        CALLS[said]()
