"""What is wrong with a protocol's files, each with its line and what to write instead."""

import ast

import pytest

from innervate.dialect import folder, sends
from innervate.dialect.folder import HANDLERS, ON_AIR


@pytest.fixture
def file(tmp_path):
    """Writes a source, and gives its path."""

    def write(text, name="protocol.py"):
        path = tmp_path / name
        path.write_text(text)
        return path

    return write


def said(findings):
    """Line and text of each."""
    return [(one.line, one.text) for one in findings]


WHOLE = '"""Doc."""\n\nTIMERS = 1\n' + "".join(
    f'\n\ndef {name}{arguments}:\n    """Doc."""\n' for name, arguments in HANDLERS.items()
)


def test_a_whole_protocol_has_nothing_wrong(file):
    path = file(WHOLE)
    assert folder.of_source(path, set(), "", HANDLERS) == []
    assert folder.of_source(path, set(), "", {}) == []


@pytest.mark.parametrize(("old", "new", "line", "says"), [
    ("def on_timer(", "def on_timers(", 1, "has no on_timer; add def on_timer(state, params, now"),
    ("(state, params, now, cause, out)", "(state, params, now, out)", 6,
     "on_start takes 4 arguments; it is on_start(state, params, now, cause, out)"),
    ("TIMERS = 1", "TIMER = 1", 1, "has no TIMERS; add TIMERS = 1"),
    ('"""Doc."""\n\n\ndef on_timer', "return 1.5\n\n\ndef on_timer", 10,
     "on_frame has no docstring"),
])  # fmt: skip
def test_what_a_protocol_lacks(file, old, new, line, says):
    path = file(WHOLE.replace(old, new, 1))
    found = folder.of_source(path, set(), "", HANDLERS)
    assert found[0].line == line
    assert found[0].text.startswith(says)
    assert str(found[0]) == f"{path}:{line}: {found[0].text}"
    assert not found[0].in_plain


def test_other_files_need_no_handlers_and_no_timers(file):
    assert folder.of_source(file('"""Doc."""\n'), set(), "", {}) == []


@pytest.mark.parametrize(("more", "wrong"), [
    ("", []), ("def on_sent(state, params, now, ok, out)", []), ("def on_sent(state)", [
        "on_sent takes 1 arguments; it is on_sent(state, params, now, ok, out)"]),
])  # fmt: skip
def test_what_a_protocol_may_have_is_as_it_is_called(file, more, wrong):
    text = WHOLE + (f'\n\n{more}:\n    """Doc."""\n' if more else "")
    assert [text for _, text in said(folder.of_source(file(text), set(), "", HANDLERS))] == wrong


def test_on_the_air_carriers_are_told(file):
    found = folder.of_source(file(WHOLE), set(), "", HANDLERS | ON_AIR)
    assert said(found) == [
        (1, "has no on_carrier; add def on_carrier(state, params, now, cd, voc, out)")
    ]


def test_what_debugs_is_wrong_but_for_plain_runs(file):
    text = WHOLE.replace(
        '"""Doc."""\n\n\ndef on_timer', '"""Doc."""\n    print(now)\n\n\ndef on_timer'
    )
    (one,) = folder.of_source(file(text), set(), "", HANDLERS)
    assert (one.line, one.in_plain) == (12, True)


def test_what_is_no_python_or_no_text(file, tmp_path):
    assert said(folder.of_source(file("A = 1\nB = (\n"), set(), "", {}))[0][0] == 2
    assert said(folder.of_source(tmp_path / "none.py", set(), "", {}))[0][1].startswith(
        "cannot be read"
    )
    path = file("")
    path.write_bytes(b"\xff\xfe")
    assert said(folder.of_source(path, set(), "", {}))[0][1].startswith("cannot be read")


INVARIANTS = """def node_low(node, params):
    pass
def network_low(nodes, count, params):
    pass
def helper(a):
    pass
def network_up(nodes):
    pass
def network_joined(nodes, count, params, peer):
    pass
"""


def test_invariants_take_what_they_are_given(file):
    assert said(folder.of_rules(file(INVARIANTS))) == [
        (1, "node_low takes 2 arguments; it is node_low(node, params, now)"),
        (5, "helper is never looked at; begin its name with node_ or network_"),
        (
            7,
            "network_up takes 1 arguments; it is network_up(nodes, count, params) or "
            "network_up(nodes, count, params, peer)",
        ),
    ]


def test_a_rule_that_nobody_looks_at_is_told(file):
    path = file("""def node_low(node, params, now):
    return least(node)
def least(node):
    return node.low > 0
def nodes_high(nodes, count, params):
    return 1
""")
    what = "nodes_high is never looked at; begin its name with node_ or network_"
    assert said(folder.of_rules(path)) == [(5, what)]


def test_constants_are_whole_numbers_of_numbers_and_names():
    text = "A = 3\nB, C = A + 1, -A\nD = E = 1 << B\nF = 1.5\nG = F\nH = max(A, B)\n"
    text += "I = X\nJ = 1 // 0\nK = 'a'\nL = A if B else C\nM = A == 3\n"
    assert folder.constants_of(ast.parse(text)) == {
        "A": 3, "B": 4, "C": -3, "D": 16, "E": 16, "L": 3, "M": True,
    }  # fmt: skip


FIELDS = """STATE = (
    ("seq", 0, 0, 255, "", "a number"),
    ("dist", 4, 0, 15, "hops", "how far"),
)
PARAMS = (
    ("hops", 0, 1, 15, "hops", "at most"),
    ("seq", 0, 0, 1, "", "another"),
)
DEFAULTS = {"hops": 7}
"""
GOOD = ("seq", 0, 0, 255, "", "a number")


@pytest.mark.parametrize(("field", "says"), [
    (GOOD, ""), (("seq", 0, -(2**30) + 1, 2**30 - 1, "", ""), ""), (("seq", 0, 5, 5, "", ""), ""),
    (("seq", 0, 0, 255, ""), "is not whole"), (["seq"], "is not whole"),
    (("1a", 0, 0, 9, "", ""), "is no name"), (("seq", 0, 0, 9.5, "", ""), "no whole number"),
    (("seq", "4", 0, 9, "", ""), "no whole number"),
    (("seq", -1, 0, 9, "", ""), "a length below 0"),
    (("seq", 0, 0, 2**30, "", ""), "beyond 2^30"), (("seq", 0, -(2**30), 0, "", ""), "beyond 2^30"),
    (("seq", 0, 9, 8, "", ""), "from 9 to 8; put the lower first"),
    (("seq", 0, 0, 9, 1, ""), "lacks its unit"),
    (("seq", 0, 0, 9, "", None), "lacks its unit"),
])  # fmt: skip
def test_what_is_wrong_with_a_declared_field(file, field, says):
    found = said(folder.of_fields(file(FIELDS), [("STATE", (field,))]))
    if says:
        ((line, text),) = found
        assert says in text
        assert line == (2 if field[0] == "seq" and isinstance(field, tuple) else 1)
    else:
        assert found == []


def test_a_field_is_declared_once_in_its_table(file):
    twice = (GOOD, ("dist", 4, 0, 15, "", ""), ("dist", 0, 0, 1, "", ""))
    found = folder.of_fields(file(FIELDS), [("STATE", twice), ("PARAMS", (GOOD,))])
    assert said(found) == [(3, "STATE: dist is declared twice")]
    assert said(folder.of_fields(file(FIELDS), [("PARAMS", (("seq",),))]))[0][0] == 7


@pytest.mark.parametrize(("values", "says"), [
    ({"hops": 1}, ""), ({"hops": 15}, ""), ({"hops": [1, 15]}, ""),
    ({"hops": 0}, "1 to 15 hops, not 0"),
    ({"hops": 16}, "1 to 15 hops, not 16"), ({"hops": (1, 16)}, "not (1, 16)"),
    ({"hops": 1.5}, "not 1.5"), ({"hop": 1}, "hop is no parameter of PARAMS"),
])  # fmt: skip
def test_usual_values_are_in_their_ranges(file, values, says):
    params = (("hops", 0, 1, 15, "hops", "at most"),)
    found = said(folder.of_usual(file(FIELDS), [("DEFAULTS", values)], params))
    assert len(found) == bool(says)
    assert all(line == 9 and says in text for line, text in found)


SHAPE = "GIVEN is (kind, item) of each: ((1, {}),)"


@pytest.mark.parametrize(("given", "says"), [
    (((1, {}), (2, {"sq": 3})), None), ([[1, {"sq": 255}]], None), ((), None),
    (1, SHAPE), ((1, {"sq": 3}), SHAPE), (((1, 2),), SHAPE), (((1, {}, 3),), SHAPE),
    (((1, {"seq": 3}),), "GIVEN: seq is no field of FRAME"),
    (((1, {"sq": 256}),), "GIVEN: sq must be 0 to 255, not 256"),
    (((1, {"sq": [0, -1]}),), "GIVEN: sq must be 0 to 255, not [0, -1]"),
    (((1, {"sq": "x"}),), "GIVEN: sq must be 0 to 255, not x"),
])  # fmt: skip
def test_what_the_explorer_hands_to_nodes_is_a_frames(file, given, says):
    frame = (("sq", 0, 0, 255, "number", "of it"),)
    found = said(folder.of_given(file("\nGIVEN = ()\n"), given, frame))
    assert found == ([(2, says)] if says else [])


def test_names_of_the_medium_are_taken(file):
    params = (("hops", 0, 1, 15, "", ""), ("seq", 0, 0, 1, "", ""))
    found = said(folder.of_taken(file(FIELDS), params, {"seq", "wire_us"}))
    assert found == [(7, "PARAMS: seq is a word of the medium's own; choose another name")]


FRAME = (("kind", 0, 0, 3, "", ""), ("seq", 0, 0, 255, "", ""), ("way", 2, -4, 3, "", ""),
         ("rssi", 0, -128, 127, "", ""))  # fmt: skip


def laid(seq=("seq", 0, 8, False), way=("way", 2, 3, True), kind=1):
    return [(kind, "news", tuple(one for one in (seq, way, (None, 0, 5, False)) if one))]


@pytest.mark.parametrize(("given", "says"), [
    ({}, None), ({"seq": ("seq", 0, 9, False)}, None), ({"kind": 3}, None),
    ({"kind": 4}, "kind 4 of news does not fit into KIND_BITS = 2"),
    ({"kind": -1}, "kind -1 of news does not fit"),
    ({"seq": ("seq", 0, 7, False)}, "news: seq is 0 to 255 in FRAME; 7 bits hold 0 to 127"),
    ({"seq": ("seq", 0, 8, True)}, "8 bits hold -128 to 127"),
    ({"way": ("way", 2, 2, True)}, "news: way is -4 to 3 in FRAME; 2 bits hold -2 to 1"),
    ({"way": ("way", 2, 3, False)}, "3 bits hold 0 to 7"),
    ({"way": ("way", 3, 3, True)}, "way has 3 here and length 2 in FRAME"),
    ({"way": ("way", 1, 3, True)}, "way has 1 here and length 2 in FRAME"),
    ({"way": ("way", "seq", 3, True)}, "way is of variable number"),
    ({"way": ("way", 2, "seq", True)}, "way is of variable number"),
    ({"way": None}, "no frame carries way of FRAME"),
])  # fmt: skip
def test_layouts_hold_what_is_declared(file, given, says):
    path = file("A = 1\nLAYOUTS = ()\n")
    found = said(folder.of_layouts(path, laid(**given), 2, FRAME))
    assert len(found) == (says is not None)
    assert all(line == 2 and says in text for line, text in found)


def test_a_kind_is_laid_out_once(file):
    layouts = [*laid(), (1, "more", laid()[0][2])]
    (found,) = said(folder.of_layouts(file("LAYOUTS = ()\n"), layouts, 2, FRAME))
    assert found == (1, "news and more are both of kind 1; give one another number")


def test_what_is_laid_out_is_declared(file):
    found = said(folder.of_layouts(file("LAYOUTS = ()\n"), laid(seq=("sq", 0, 8, False)), 2, FRAME))
    assert [text.partition(";")[0] for _, text in found] == [
        "news: sq is no field of FRAME", "no frame carries seq of FRAME"]  # fmt: skip


def test_what_a_medium_looks_at_has_bits_in_every_layout(file):
    path, layouts = file("LAYOUTS = ()\n"), laid(seq=("seq", 0, 8, False))
    has, looked_at = [*FRAME, ("to", 0, 0, 3, "node", "")], {"to", "slots"}
    assert said(folder.of_layouts(path, layouts, 2, FRAME, looked_at)) == []
    found = [text for _, text in said(folder.of_layouts(path, layouts, 2, has, looked_at))]
    assert found[0].endswith("the medium looks at to; give it bits in every layout")


@pytest.mark.parametrize(("low", "high", "is_said"), [
    (0, 9, 0), (-9, 0, 0), (-4, 3, 0), (1, 9, 1), (-9, -1, 1),
])  # fmt: skip
def test_what_a_layout_has_no_bits_for_is_0_where_it_arrives(file, low, high, is_said):
    frame = (*FRAME, ("hops", 0, low, high, "", ""), ("made_at", 0, 1, 9, "us", ""))
    more = (2, "more", (*laid()[0][2], ("hops", 0, 5, low < 0)))
    found = said(folder.of_layouts(file("LAYOUTS = ()\n"), [*laid(), more], 2, frame))
    what = f"news: hops is {low} to {high} in FRAME, and 0 where it arrives, as it has no bits here"
    assert found == [(1, f"{what}; give it some, or let it be 0")] * is_said


SENDS = """NEWS = 1
def fill(frame, value):
    frame.kind = 0
    frame.seq = value
    tell(frame)
def tell(other):
    other.kind = {kind}
def on_timer(state, params, now, timer, out):
    frame = out.frame[send(out, 0, 0, 0)]
    fill(frame, 1)
    state.kind = 9
"""


@pytest.mark.parametrize(("kind", "wrong"), [
    ("NEWS", []), ("NEWS + 1", []), ("3", [(7, "3")]), ("NEWS + 3", [(7, "4")]), ("timer", []),
])  # fmt: skip
def test_kinds_that_are_sent_have_a_layout(file, kind, wrong):
    found = said(sends.of_kinds([file(SENDS.format(kind=kind))], {1: {"seq"}, 2: set()}))
    assert [(line, text.split()[4]) for line, text in found] == wrong


@pytest.mark.parametrize(("imported", "name"), [
    ("from gossip import sizes", "sizes.NONE"), ("from gossip import sizes as s", "s.NONE"),
    ("import gossip.sizes as s", "s.NONE"), ("from gossip.sizes import NONE as NO", "NO"),
])  # fmt: skip
def test_kinds_of_other_files_have_a_layout_by_whatever_name(file, imported, name):
    sizes = file("NONE = 3\n", "sizes.py")
    path = file(f"{imported}\n{SENDS.format(kind=name)}")
    found = said(sends.of_kinds([path, sizes], {1: {"seq"}, 2: set()}))
    assert found == [(8, "a frame of kind 3 is sent, and has no layout; add one to LAYOUTS")]


FILLS = """NEWS, HELLO = 1, 2
def on_timer(state, params, now, timer, out):
    frame = out.frame[send(out, 0, 0, 0)]
    frame.kind = HELLO
    frame.seq = 0
    frame.made_at = now
    frame.{field} = state.seq
    other = out.frame[send(out, 0, 0, 0)]
    other.kind = timer
    other.seq = 1
    told = out.frame[deliver(out, NEWS)]
    told.kind = HELLO
    told.seq = 1
"""


@pytest.mark.parametrize(("field", "wrong"), [
    ("low", []), ("low[1]", []), ("seq", [7]), ("seq[0]", [7]),
])  # fmt: skip
def test_what_a_layout_has_no_bits_for_is_not_sent(file, field, wrong):
    path = file(FILLS.format(field=field))
    what = "seq has no bits in the layout of kind 2, and is not sent"
    found = said(sends.of_kinds([path], {1: {"seq", "low"}, 2: {"low"}}))
    assert found == [(line, what) for line in wrong]


@pytest.mark.parametrize(("more", "kinds", "wrong"), [
    ("", {1}, [2]), ("", {0, 1}, []), ("    frame.kind = 1\n", {1}, []),
    ("    fill(frame, 2)\n", {1}, []), ("    other = frame\n", {1}, []),
    ("    other = frame.seq\n", {1}, [2]),
])  # fmt: skip
def test_a_frame_is_sent_with_a_kind(file, more, kinds, wrong):
    text = "def on_timer(state, params, now, timer, out):\n"
    text += "    frame = out.frame[send(out, 0, 0, 0)]\n    frame.seq = 4\n" + more
    found = said(sends.of_kinds([file(text)], {kind: {"seq"} for kind in kinds}))
    assert found == [(line, "frame is sent without a kind; set one") for line in wrong]


def test_only_over_cables_a_frame_leaves_later(file):
    path = file("""SOON, NOW = 3, 0
def on_timer(state, params, now, timer, out):
    send(out, 0, SOON, 0)
    send(out, 0, NOW, 0)
    send(out, 0, params.wait_us, 0)
""")
    what = "only over cables a frame leaves later; send it from on_timer"
    assert said(sends.of_delays([path])) == [(3, what), (5, what)]


def test_reports_of_a_channel_are_its_own(file):
    path = file("from x import REPORT_LEFT\nTIMERS, REPORT_A = 1, 2\nREPORT_B = 4 * REPORT_A\n")
    what = "REPORT_B = 8 is a report of the channel's own; choose another number"
    assert said(sends.of_channel([path])) == [(3, what)]
    assert said(sends.of_channel([file("REPORT_C = 1\n")]))


USES = """from innervate.dialect import arith
SOON = 1
def on_timer(state, params, now, t, out):
    state.seq = state.sqe + arith.MASK
    set_timer(out, SOON, now)
    set_timer(out, SOON + 1, out.count[0])
    set_timer(out, t, now)
    set_timer(out, -1, state.sqe)
    state.zzzzzz = 0
"""


def test_fields_and_timers_that_are_used_are_there(file):
    near = 'sqe is no field that fields.py declares; did you mean "seq"?'
    assert sorted(said(folder.of_uses(file(USES), {"seq", "dist"}, 2))) == [
        (4, near), (6, "sets timer 2, and TIMERS = 2; write TIMERS = 3"),
        (8, "sets timer -1, and TIMERS = 2; write TIMERS = 0"), (8, near),
        (9, "zzzzzz is no field that fields.py declares"),
    ]  # fmt: skip


def test_fields_with_a_length_are_set_place_by_place(file):
    path = file("""def on_start(node, params, now, cause, out):
    node.seen[0] = node.seen[1]
    node.seq = 0
    node.seen = 0
    node.seen += 1
""")
    found = said(folder.of_uses(path, {"seen", "seq"}, 1, {"seen"}))
    what = "seen has a length; set its places one by one, seen[i]"
    assert found == [(4, what), (5, what)]
