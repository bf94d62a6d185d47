"""How a scenario that breaks something is made smaller: what is tried, and how often."""

from innervate.running import fuzz

LINE = {"kind": "skin", "patch": [{"columns": 3, "rows": 1}],
        "interface": [{"row": 0, "column": 0}]}  # fmt: skip


def events(*names):
    return [{"at_s": 0.1, "action": name} for name in names]


def first_events(tables, count):
    """The events of the first scenarios that are tried, by their actions."""
    tried = zip(range(count), fuzz.smaller(tables), strict=False)
    return ["".join(event["action"] for event in one["event"]) for _, one in tried]


def test_halves_are_tried_first_then_all_but_one_event():
    assert first_events(LINE | {"event": events(*"abcd")}, 6) == [
        "ab", "cd", "bcd", "acd", "abd", "abc",
    ]  # fmt: skip
    assert first_events(LINE | {"event": events(*"abc")}, 5) == ["a", "bc", "bc", "ac", "ab"]


def test_one_event_is_left_out_and_not_tried_again_as_a_half():
    tables = LINE | {"event": events("a")}
    assert first_events(tables, 2) == ["", ""]  # the empty half, and all but this one


def test_tries_are_counted_and_bounded(monkeypatch):
    asked = []

    def breaks(tables):
        asked.append(tables)
        return "yes" if len(asked) in (1, 3) else ""

    small, tries = fuzz.shrink(LINE | {"event": events(*"abcd")}, breaks)
    assert tries == len(asked)
    assert small == asked[2]
    monkeypatch.setattr(fuzz, "TRIES", 4)
    asked.clear()
    _, tries = fuzz.shrink(LINE | {"event": events(*"abcd")}, lambda t: asked.append(t) or "")
    assert (tries, len(asked)) == (4, 3)
