"""How large figures are kept and shown, and that nothing of how they are drawn stays behind."""

import struct

import matplotlib

from innervate.plot import style


def pixels(png):
    """Width and height of a PNG, and its points a metre."""
    density = struct.unpack(">II", png[png.index(b"pHYs") + 4 :][:8])
    return struct.unpack(">II", png[16:24]), density


def test_figures_are_kept_with_300_dots_an_inch_and_shown_with_130(tmp_path):
    with style.house():
        made, (axes,) = style.panels(1.0, 0.5)
        axes.axis("off")
        png, svg = style.save(made, tmp_path, "small")
    assert [path.name for path in sorted(tmp_path.iterdir())] == ["small.png", "small.svg"]
    assert pixels(png.read_bytes()) == ((300, 150), (11811, 11811))
    text = svg.read_text()
    assert 'width="72pt" height="36pt"' in text
    assert "<dc:date>" not in text
    assert pixels(made._repr_png_()) == ((130, 65), (5118, 5118))
    assert b"Software" not in png.read_bytes() + made._repr_png_()
    assert made.get_layout_engine() is not None


def test_whatever_the_user_has_set_is_as_before():
    with matplotlib.rc_context({"font.size": 31.0, "savefig.dpi": 7}):
        with style.house():
            assert (matplotlib.rcParams["font.size"], matplotlib.rcParams["savefig.dpi"]) == (
                7.5, 300,
            )  # fmt: skip
        assert (matplotlib.rcParams["font.size"], matplotlib.rcParams["savefig.dpi"]) == (31, 7)
