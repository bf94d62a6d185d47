"""A counterexample as a page of panels: where they stand, how its sentences are set."""

import math

import pytest

from innervate.plot import panels
from innervate.plot.svg import Drawing

WIDE, HIGH, TOP, LINE = 210, 190, 34, 15


@pytest.mark.parametrize(("count", "rows"), [(0, 0), (1, 1), (4, 1), (5, 2), (9, 3)])
def test_panels_stand_in_rows_of_four_and_sentences_below(count, rows, parse):
    page = panels.page("a ring", [panels.panel(i) for i in range(count)], ["first", "second"])
    assert (page.width, page.height) == (4 * WIDE, TOP + rows * HIGH + 4 * LINE)
    tree = parse(page)
    moved = [node.get("transform") for node in tree.iter() if node.tag.endswith("}g")]
    assert moved == [f"translate({WIDE * (i % 4)} {TOP + HIGH * (i // 4)})" for i in range(count)]
    said = [(node.text, float(node.get("y"))) for node in tree if node.tag.endswith("text")]
    below = TOP + rows * HIGH
    assert said == [("a ring", 22), ("1. first", below + LINE), ("2. second", below + 2 * LINE)]
    heads = [node.text for node in tree.iter() if node.get("class") == "small"]
    assert heads == [f"after {i + 1}" for i in range(count)]


@pytest.mark.parametrize("long", [1, 7, 20, 59, 60])
def test_a_sentence_is_set_in_lines_that_lose_nothing(long):
    text = " ".join(["x" * long] * 40)
    lines = panels.wrapped(text)
    assert " ".join(line.strip() for line in lines) == text
    assert not lines[0].startswith(" ")
    assert all(line.startswith("    x") for line in lines[1:])
    assert all(len(line) <= panels.LETTERS + 4 for line in lines)
    assert all(len(line) + 1 + long > panels.LETTERS for line in lines[:-1])


def lines(drawing, parse):
    return [tuple(float(node.get(name)) for name in ("x1", "y1", "x2", "y2"))
            for node in parse(drawing).iter() if node.tag.endswith("}line")]  # fmt: skip


@pytest.mark.parametrize("turn", [0, 1, 2.5, 4])
def test_an_arrow_goes_from_rim_to_rim_and_its_barbs_lie_back(turn, parse):
    drawing = Drawing(300, 300, "x")
    far = (150 + 100 * math.cos(turn), 150 + 100 * math.sin(turn))
    panels.arrow(drawing, (150, 150), far, "way")
    shaft, *barbs = lines(drawing, parse)
    assert math.dist(shaft[:2], (150, 150)) == pytest.approx(15, abs=0.02)
    assert math.dist(shaft[2:], far) == pytest.approx(17, abs=0.02)
    assert math.dist(shaft[:2], shaft[2:]) == pytest.approx(100 - 32, abs=0.02)
    for barb in barbs:
        assert barb[:2] == shaft[2:]
        assert math.dist(barb[:2], barb[2:]) == pytest.approx(9, abs=0.02)
        back = math.dist(barb[2:], (150, 150))
        assert back < math.dist(barb[:2], (150, 150))
    a, b = (math.dist(barb[2:], shaft[:2]) for barb in barbs)
    assert a == pytest.approx(b, abs=0.02)
    assert math.dist(barbs[0][2:], barbs[1][2:]) == pytest.approx(
        18 * math.sin(math.pi - 2.6), abs=0.03
    )


@pytest.mark.parametrize(("is_end", "is_actor", "kind", "name"), [
    (True, False, "pc", "portname"), (False, False, "node", "small"),
    (False, True, "node actor", "small"),
])  # fmt: skip
def test_a_node_is_a_disc_with_its_name_in_the_middle(is_end, is_actor, kind, name, parse):
    drawing = Drawing(300, 300, "x")
    panels.disc(drawing, (40, 50), "n1", is_end, is_actor)
    circle, text = parse(drawing)
    assert {key: circle.get(key) for key in ("class", "cx", "cy", "r")} == {
        "class": kind, "cx": "40", "cy": "50", "r": "15"}  # fmt: skip
    assert (text.text, text.get("class"), text.get("x"), text.get("y")) == ("n1", name, "40", "54")
    assert text.get("text-anchor") == "middle"


@pytest.mark.parametrize(("label", "rows"), [
    ("n12", [("n12", 104.0)]), ("left", [("left", 104.0)]), ("right", [("right", 104.0)]),
    ("p0 r0 c0", [("p0", 95.0), ("r0", 104.0), ("c0", 113.0)]), ("a 1", [("a 1", 104.0)]),
    ("arm 12", [("arm", 99.5), ("12", 108.5)]),
])  # fmt: skip
def test_a_long_name_stands_in_its_disc_word_by_word(parse, label, rows):
    drawing = panels.panel(0)
    panels.disc(drawing, (50.0, 100.0), label, is_end=False, is_actor=True)
    texts = [one for one in parse(drawing).iter() if one.tag.endswith("text")][1:]
    assert [(one.text, float(one.get("y"))) for one in texts] == rows
