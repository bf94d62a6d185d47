"""What is drawn where there is little room: cuts at a port, arrows, boxes, values, plots."""

from math import dist

import pytest

from tests.browser.servers import PHONE, beside, place
from tests.browser.test_design import DRAWN, RING, SIZES, WRITTEN, box, hold
from tests.browser.test_kinds import written

# What the map has of the accent's colour: lines, each from where a pen was set down, as corners.
LINES = """
window.Path2D = class extends Path2D {
  lines = [];
  moveTo(x, y) { this.lines.push([[x, y]]); super.moveTo(x, y); }
  lineTo(x, y) { this.lines.at(-1).push([x, y]); super.lineTo(x, y); }
};
const stroke = CanvasRenderingContext2D.prototype.stroke;
CanvasRenderingContext2D.prototype.stroke = function (path) {
  if (this.strokeStyle === "#0063a6" && this.canvas.closest("#stage")) window.arrows = path.lines;
  return stroke.apply(this, arguments);
};
"""
# Boxes with a rim: [how wide, its colour].
RIMS = """
window.rims = [];
const rim = CanvasRenderingContext2D.prototype.strokeRect;
CanvasRenderingContext2D.prototype.strokeRect = function (x, y, wide) {
  if (this.canvas.closest("#timeline")) window.rims.push([wide, this.strokeStyle]);
  return rim.apply(this, arguments);
};
"""
# How many px round a place of the page are of a colour, on a canvas of the map.
PX_OF = """([x, y, colour]) => {
  const box = document.querySelector("#stage").getBoundingClientRect();
  const canvas = document.querySelectorAll("#stage canvas")[1];
  const ratio = canvas.width / box.width, wide = 20 * ratio;
  const left = (x - box.left - 10) * ratio, top = (y - box.top - 10) * ratio;
  const { data } = canvas.getContext("2d").getImageData(left, top, wide, wide);
  const [r, g, b] = colour;
  let found = 0;
  for (let i = 0; i < data.length; i += 4)
    found += data[i] === r && data[i + 1] === g && data[i + 2] === b && data[i + 3] === 255;
  return found / ratio ** 2;
}"""
ALARM = [0xC4, 0x3D, 0x00]  # in light


@pytest.mark.parametrize("size", [PHONE, SIZES[1]])
def test_a_cable_that_is_cut_at_a_port_is_seen_among_cells_without_a_way(look, size):
    with beside("demo", 0.1) as address:
        page = look(address, size)
        hold(page, 2.008)
        at = place(page, "p0 r16 c7 - pc.1")
        assert page.evaluate(PX_OF, [*at, ALARM]) > 20


def drawn(page, at_s, what):
    """What a page's script has noted of the picture of a moment."""
    hold(page, at_s)
    page.evaluate(DRAWN)
    return page.evaluate(f"window.{what}")


def test_every_way_of_a_dense_mesh_on_a_phone_is_an_arrow(look):
    with beside("mesh-leipzig", 0, settings=["import.nodes=32"]) as address:
        lines = drawn(look(address, PHONE, script=LINES), 20.0, "arrows")
        assert len(lines) == 2 * 31  # a shaft and a head of all but the gateway
        for (begin, end), (left, tip, _) in zip(lines[::2], lines[1::2], strict=True):
            assert tip == end
            assert dist(left, tip) < dist(begin, end)


def test_a_narrow_box_has_its_colour_and_no_rim(look):
    with beside("radio-churn", 0.1) as address:
        rims = drawn(look(address, PHONE, script=RIMS), 5.0, "rims")
        assert rims
        assert all(wide >= 4 for wide, colour in rims if colour != "#c43d00")


def test_values_stand_at_the_nodes_that_they_colour(look):
    with beside("babel-patch", 0.1) as address:
        page = look(address, PHONE, script=WRITTEN)
        hold(page, 0.3)
        assert {"n0: 0", "n15: 0"} <= written(page)


def test_on_a_large_screen_no_place_between_plots_is_empty(look, tmp_path):
    (tmp_path / "ring.toml").write_text(RING)
    with beside(tmp_path / "ring.toml", 0.01) as address:
        page = look(address, SIZES[1])
        page.evaluate(DRAWN)
        first, *_, last = (one.bounding_box() for one in page.locator(".plot").all())
        edge = box(page, "#plots")
        assert last["y"] > first["y"]
        assert last["x"] + last["width"] == edge["x"] + edge["width"]


@pytest.mark.parametrize("size", SIZES)
def test_what_a_plot_is_of_is_read_whole_at_any_size(look, size):
    with beside("demo", 0.1, held=True) as address:
        page = look(address, size)
        page.evaluate("""() => {
          document.querySelector(".plot span").textContent = "frames received, all nodes";
          document.querySelector(".plot b").textContent = "12,345 per s";
        }""")
        name = page.locator(".plot span").first
        assert name.evaluate("name => name.scrollWidth <= name.clientWidth")
        value, plot = (page.locator(one).first.bounding_box() for one in (".plot b", ".plot"))
        assert value["x"] + value["width"] <= plot["x"] + plot["width"]
