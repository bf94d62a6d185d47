"""A handler beside its formula: what is told where they differ, and what may not be compared."""

import random
from types import SimpleNamespace as Of

import pytest

from innervate.dialect.outbox import SEND, SET_TIMER
from innervate.prove.errors import ProveError
from innervate.prove.records import Record
from tests.prove.parity import TRIES, Twin

FRAME = (("kind", 0, 0, 7, "kind", ""), ("to", 2, 1, 30, "x", ""))


def twin():
    made = Twin.__new__(Twin)
    made.step = Of(name="on_timer")
    made.actions = [Of(kind=SEND, frame=Record("out0", FRAME)),
                    Of(kind=SET_TIMER, frame=Record("out1"))]  # fmt: skip
    return made


SENT, SET = [1, 2, 3, 4, 5, 6, 7], [1, 8, 9, 0]  # guard, a, b, c, and a frame's fields


def outbox(*actions):
    """What Python put out: (kind, a, b, c, kind and to of a frame)."""
    return Of(count=[len(actions)],
              action=[Of(kind=kind, a=a, b=b, c=c) for kind, a, b, c, *_ in actions],
              frame=[Of(kind=rest[0], to=rest[1]) if rest else None
                     for *_, rest in [(*one[:4], one[4:]) for one in actions]])  # fmt: skip


FIRST, SECOND = (SEND, 2, 3, 4, 5, [6, 7]), (SET_TIMER, 8, 9, 0)
DIFFERENT = [
    ([FIRST, SECOND], SENT + SET, ""), ([SECOND], [0, *SENT[1:], *SET], ""),
    ([FIRST], [*SENT, 0, *SET[1:]], ""), ([], [0, *SENT[1:], 0, *SET[1:]], ""),
    ([FIRST], SENT + SET, "action 1 is in the formula alone"),
    ([FIRST, SECOND], [*SENT, 0, *SET[1:]], "2 actions, not 1"),
    ([FIRST, SECOND, SECOND], SENT + SET, "3 actions, not 2"),
    ([(SET_TIMER, *FIRST[1:]), SECOND], SENT + SET, "action 0 is "),
    ([(SEND, 1, 3, 4, 5, [6, 7]), SECOND], SENT + SET, "action 0 is "),
    ([(SEND, 2, 1, 4, 5, [6, 7]), SECOND], SENT + SET, "action 0 is "),
    ([(SEND, 2, 3, 1, 5, [6, 7]), SECOND], SENT + SET, "action 0 is "),
    ([(SEND, 2, 3, 4, 1, [6, 7]), SECOND], SENT + SET, "action 0: kind is 1, in the formula 5"),
    ([(SEND, 2, 3, 4, 5, [6, 1]), SECOND], SENT + SET, "action 0: to is [6, 1], in the formula 7"),
    ([FIRST, (SET_TIMER, 8, 9, 1)], SENT + SET, "action 1 is "),
]  # fmt: skip


@pytest.mark.parametrize(("put_out", "values", "said"), DIFFERENT)
def test_where_actions_differ_it_is_told(put_out, values, said):
    found = twin()._actions_differ(values, outbox(*put_out))
    assert found.startswith(said)
    assert bool(found) == bool(said)


def called(*answers, count=2):
    made, left = twin(), list(answers)
    made.same = lambda draw: left.pop(0)
    return made.calls(count, 5), left


def test_so_many_calls_are_compared_and_the_first_that_differs_is_told():
    assert called("", "") == ("", [])
    assert called(None, "", None, None, "", "left") == ("", ["left"])
    said, left = called("", None, "it returns 3", "left", count=9)
    assert (said, left) == ("on_timer, call 2 of seed 5: it returns 3", ["left"])
    with pytest.raises(ProveError, match="on_timer: 1 of 100 drawn calls may be"):
        called("", *[None] * (2 * TRIES - 1))


def asked(formula, handler, width=4):
    made = twin()
    made.fresh, made.declared, made.classes, made.args = {}, {}, {}, (("n", 3, 3),)
    made.frame_class, made.widths = type("Sent", (), {}), [0, width]
    made.formula = lambda known, scripted: formula
    made.handler = handler
    made._differs = lambda *_: ""
    return made.same(random.Random(1))


def test_what_no_invariant_allows_is_not_compared():
    def never(*_):
        raise AssertionError("called")

    assert asked((False, 0), never) is None


@pytest.mark.parametrize(("returned", "result", "width", "said"), [
    (3, 3, 4, ""), (None, 0, 4, ""), (-1, 15, 4, ""), (1, True, 0, ""),
    (3, 2, 4, "it returns 3, in the formula 2"), (15, 15, 4, "it returns 15, in the formula 15"),
])  # fmt: skip
def test_what_is_returned_is_compared(returned, result, width, said):
    assert asked((True, result), lambda n: returned, width) == said
