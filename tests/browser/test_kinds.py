"""The page of a radio team and of a mesh."""

from tests.browser.servers import beside, click, expect

RADIO = """
kind = "radio"
name = "three"
duration_s = 60
stations = 3
[traffic]
kind = "saturated"
"""
MESH = """
kind = "mesh"
name = "a row"
duration_s = 60
[[node]]
name = "home"
x_m = 0
y_m = 0
[[node]]
name = "middle"
x_m = 25
y_m = 0
[[node]]
name = "far"
x_m = 50
y_m = 0
[fence]
polygon = [[-10, -10], [60, -10], [60, 10], [-10, 10]]
"""
PAINTED = """(selector) => [...document.querySelectorAll(`${selector} canvas`)]
  .map((canvas) => canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data)
  .reduce((sum, data) => sum + data.filter((value, i) => i % 4 === 3 && value).length, 0)"""


def test_a_radio_team(look, tmp_path):
    path = tmp_path / "radio.toml"
    path.write_text(RADIO)
    with beside(path, 0.1) as address:
        page = look(address)
        expect(page.locator("#timeline")).to_be_visible()
        expect(page.locator("#unconnected .more")).to_have_text("of 3 stations")
        click(page, "station 1")
        expect(page.locator("#selected-facts")).to_have_text("switched off")
        expect(page.locator("#unconnected output")).to_have_text("1")
        assert page.evaluate(PAINTED, "#timeline") > 1000
        assert page.evaluate(PAINTED, "#stage") > 1000


def test_a_mesh(look, tmp_path):
    path = tmp_path / "mesh.toml"
    path.write_text(MESH)
    with beside(path, None) as address:
        page = look(address, colours="dark")
        expect(page.locator("#unconnected .more")).to_have_text("of 3 nodes")
        expect(page.locator("#unconnected output")).to_have_text("0")
        click(page, "far")
        expect(page.locator("#selected-facts")).to_contain_text("switched off")
        click(page, "far")
        expect(page.locator("#selected-facts")).not_to_contain_text("switched off")
        click(page, "home - middle")
        expect(page.locator("#selected-facts")).to_contain_text("link, cut")
        expect(page.locator("#recovery .more")).to_contain_text("home")
        assert page.evaluate(PAINTED, "#stage") > 1000
