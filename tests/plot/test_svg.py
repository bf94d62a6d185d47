import math

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from innervate.plot import svg, theme


@pytest.mark.parametrize(
    ("value", "text"),
    [(1.0, "1"), (-0.001, "0"), (0.125, "0.12"), (-2.5, "-2.5"), (1e6, "1000000"), (0, "0")],
)
def test_numbers_are_short(value, text):
    assert svg.number(value) == text


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_numbers_must_be_finite(value):
    with pytest.raises(ValueError, match="finite"):
        svg.number(value)
    with pytest.raises(ValueError, match="finite"):
        svg.Drawing(10, 10, "x").line((0, 0), (value, 1), "axis")


@given(st.text(), st.text())
def test_any_text_makes_well_formed_xml(parse, label, words):
    assume("nan" not in f"{label} {words}".lower())  # as parse() takes it for a number that is none
    drawing = svg.Drawing(10, 10, label)
    drawing.text((1, 2), words)
    drawing.path("M0,0h1", "cell", words)
    tree = parse(drawing.render("text{fill:red}"))
    shown = next(node.text for node in tree.iter() if node.tag.endswith("}text")) or ""
    kept = [a for a in words if a.isprintable()]
    assert [a for a in shown if a.isprintable() and a != "\ufffd"] == [
        a for a in kept if a != "\ufffd"
    ]


def test_labels_and_tips(parse):
    drawing = svg.Drawing(20, 10, 'cut "A" & <B>')
    drawing.path("M0,0h3v4z", "bar", "p0 r1 c2")
    tree = parse(drawing)
    assert tree.get("aria-label") == 'cut "A" & <B>'
    assert tree.get("role") == "img"
    assert "p0 r1 c2" in [node.text for node in tree.iter()]


def test_a_drawing_beside_words_that_say_it_is_not_read_aloud(parse):
    tree = parse(svg.Drawing(20, 10, ""))
    assert tree.get("aria-hidden") == "true"
    assert tree.get("role") is tree.get("aria-label") is None


def test_alone_it_carries_its_colours(parse, tmp_path):
    drawing = svg.Drawing(20, 10, "x")
    drawing.save(tmp_path / "x.svg", theme.drawing_style())
    text = (tmp_path / "x.svg").read_text()
    parse(text)
    assert "prefers-color-scheme:dark" in text
    assert "--alarm" in text


def test_drawings_nest(parse):
    inner, outer = svg.Drawing(5, 5, "in"), svg.Drawing(20, 20, "out")
    inner.circle((1, 1), 1, "touch")
    outer.place(inner, (10, 3))
    group = parse(outer)[0]
    assert group.get("transform") == "translate(10 3)"
    assert len(group) == 1


def test_every_class_of_the_style_sheet_is_defined_for_both_schemes():
    style = theme.drawing_style()
    for letter in "pdh":
        for shade in range(theme.SHADES):
            assert style.count(f"--{letter}{shade}:#") == 3  # light, dark, paper
    used = {part.split(")")[0] for part in style.split("var(")[1:]}
    assert all(f"{name}:" in style for name in used)


@pytest.mark.parametrize(
    ("value", "most", "shade"),
    [(0, 5, 0), (5, 5, 7), (9, 5, 7), (-1, 5, 0), (2.5, 5, 4), (1, 0, 0)],
)
def test_shades(value, most, shade):
    assert theme.shade(value, most) == shade
