"""The page of a radio team and of a mesh."""

import re
from math import dist

from innervate.scenario import load
from tests.browser.servers import PHONE, beside, click, expect, facts, place, seek
from tests.browser.test_design import DRAWN, WORDS_OF, WRITTEN, hold

RADIO = """
kind = "radio"
name = "three"
duration_s = 60
stations = 3
[traffic]
kind = "saturated"
"""


def row_of(*names):
    """A mesh of these nodes, 25 m apart."""
    nodes = (
        f'[[node]]\nname = "{name}"\nx_m = {25 * k}\ny_m = 0\n' for k, name in enumerate(names)
    )
    return "".join(['kind = "mesh"\nname = "a row"\nduration_s = 60\n', *nodes])


MESH = row_of("home", "middle", "far") + (
    "[fence]\npolygon = [[-10, -10], [60, -10], [60, 10], [-10, 10]]\n"
)
PAINTED = """(selector) => [...document.querySelectorAll(`${selector} canvas`)]
  .map((canvas) => canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data)
  .reduce((sum, data) => sum + data.filter((value, i) => i % 4 === 3 && value).length, 0)"""


def test_who_left_a_team_is_told_from_who_is_off(look, tmp_path):
    path = tmp_path / "radio.toml"
    gone = "".join(f'[[event]]\nat_s = 0.0{i}\naction = "{word}"\nstation = {i}\n'
                   for i, word in enumerate(("leave", "kill"), 1))  # fmt: skip
    path.write_text(RADIO.replace("stations = 3", "stations = 4") + gone)
    with beside(path, 0.1) as address:
        page = look(address)
        expect(page.locator("#unconnected output")).to_have_text("1")
        more = "of 4 stations; 1 more not in the team"
        expect(page.locator("#unconnected .more")).to_have_text(more)


def test_a_radio_team(look, tmp_path):
    path = tmp_path / "radio.toml"
    path.write_text(RADIO)
    with beside(path, 0.1) as address:
        page = look(address)
        expect(page.locator("#timeline")).to_be_visible()
        expect(page.locator("#unconnected .more")).to_have_text("of 3 stations")
        click(page, "station 1", "switched off")
        expect(page.locator("#unconnected output")).to_have_text("1")
        assert page.evaluate(PAINTED, "#timeline") > 1000
        assert page.evaluate(PAINTED, "#stage") > 1000


def test_at_the_end_a_short_run_fills_the_timeline(look, tmp_path):
    path = tmp_path / "radio.toml"
    path.write_text(RADIO.replace("saturated", "disaster"))
    with beside(path, 0) as address:
        page = look(address, script=WRITTEN)
        expect(page.locator("#clock")).to_contain_text("end")
        page.evaluate(DRAWN)
        words = {text for text, *_ in page.evaluate(WORDS_OF, "#timeline canvas")[0]}
        assert words >= {"D", "R"}, "boxes are too narrow for their letters"
        at, end = page.locator("#seek").evaluate("(seek) => [seek.valueAsNumber, Number(seek.max)]")
        assert 0 < at == end < 1, "the slider was at its beginning, of 60 s"
        expect(page.locator("#clock")).to_have_text(re.compile(r"^0\.\d+ s / 0\.\d+ s \u2013 end$"))


def test_names_from_right_to_left_are_set_apart_and_saved_as_they_are(look, tmp_path):
    path = tmp_path / "mesh.toml"
    path.write_text(row_of("שלום 1", "far").replace("a row", "عقدة"))
    with beside(path, None) as address:
        page = look(address)
        assert page.title() == "\u2068عقدة\u2069 - innervate watch"
        click(page, "\u2068שלום 1\u2069 - far", has="link, cut")  # noqa: RUF001
        with page.expect_download() as told:
            page.locator("#save").click()
        assert load(str(told.value.path())).model.node[0].name == "שלום 1"


def test_a_mesh(look, tmp_path):
    path = tmp_path / "mesh.toml"
    path.write_text(MESH)
    with beside(path, None) as address:
        page = look(address, colours="dark")
        expect(page.locator("#unconnected .more")).to_have_text("of 3 nodes")
        expect(page.locator("#unconnected output")).to_have_text("0")
        for name in ("since the last cut", "recovery", "without a way"):
            expect(page.get_by_role("status", name=name, exact=True)).to_be_visible()
        click(page, "far", has="switched off")
        click(page, "far")
        expect(facts(page)).not_to_contain_text("switched off")
        click(page, "home - middle", has="link, cut")
        expect(page.locator("#recovery .more")).to_contain_text("home")
        assert page.evaluate(PAINTED, "#stage") > 1000


STANDBY = MESH.replace("duration_s = 60", "duration_s = 20\nstandby = [1]") + (
    '[[event]]\nat_s = 5\naction = "kill"\nnode = "home"\n'
)


def test_who_leads_a_mesh_now_is_its_gateway_on_the_map(look, tmp_path):
    path = tmp_path / "mesh.toml"
    path.write_text(STANDBY)
    with beside(path, None) as address:
        page = look(address, script=WRITTEN)
        hold(page, 4.0)
        assert {"home gateway", "middle standby", "far"} <= written(page)
        hold(page, 19.0)
        assert {"home", "middle gateway", "far"} <= written(page)
        click(page, "middle", "gateway")


GRID = """
kind = "flooding"
nodes = 30
layout = "grid"
spacing_m = 20
duration_s = 1
[air]
reach_m = 30
"""


def test_names_on_a_crowded_map_are_nearer_to_their_node_than_to_another(look, tmp_path):
    path = tmp_path / "grid.toml"
    path.write_text(GRID)
    with beside(path, 0, held=True) as address:
        page = look(address, PHONE, script=WRITTEN)
        page.evaluate(DRAWN)
        stage = page.locator("#stage").bounding_box()
        places = {}
        for i in range(30):
            x, y = place(page, f"node {i}")
            places[f"node {i}"] = (x - stage["x"], y - stage["y"])
        words = [one for canvas in page.evaluate(WORDS_OF, "#stage canvas") for one in canvas]
        assert len(words) >= 12
        for text, left, top, right, low in words:
            away = {
                name: max(left - x, x - right, 0) ** 2 + max(top - y, y - low, 0) ** 2
                for name, (x, y) in places.items()
            }
            assert min(away, key=away.get) == text.partition(":")[0]
        expect(page.locator("#log ol")).to_be_empty()
        said = "getComputedStyle(document.querySelector('#log ol'), '::before').content"
        assert page.evaluate(said) == '"nothing yet"'


ROUNDS = """window.rounds = [];
const arc = Path2D.prototype.arc;
Path2D.prototype.arc = function (x, y, radius) {
  window.rounds.push([x, y, radius]);
  return arc.apply(this, arguments);
};"""


def test_a_dense_mesh_on_a_phone_shows_its_gateway_and_node_by_node(look):
    # Where nodes lie is known before any acts: a loop for as many takes half a minute to compile.
    with beside("mesh-leipzig", 0, held=True) as address:
        page = look(address, PHONE, script=WRITTEN + ROUNDS)
        expect(page.locator("#clock")).to_have_text(re.compile(r"^0\.0+ s"))
        page.evaluate("window.rounds.length = 0")
        page.set_viewport_size({"width": 380, "height": 740})  # all is drawn anew
        assert {"2 gateway", "2"} & written(page)
        places = {tuple(one) for one in page.evaluate("window.rounds")}
        assert len(places) >= 85
        near = [min(dist(one[:2], two[:2]) - one[2] - two[2] for two in places - {one})
                for one in places]  # fmt: skip
        assert sum(gap < 0 for gap in near) < 0.1 * len(near), "dots lie on each other"


def written(page):
    """What is written on the map."""
    page.evaluate(DRAWN)
    return {text for canvas in page.evaluate(WORDS_OF, "#stage canvas") for text, *_ in canvas}


def test_at_the_end_of_a_disaster_nobody_sends_and_all_is_counted(look):
    with beside("radio-disaster", 0.1) as address:
        page = look(address, script=WRITTEN)
        seek(page, 60)
        expect(page.locator("#go")).to_have_text("Replay")
        expect(page.locator("#headline")).to_have_text("All 10 packets were delivered.")
        last = page.locator("#plots b").last
        expect(last).to_contain_text(" ms")  # from offer to delivery
        # The end of the last frame is still on its way to some, so that the channel is not free.
        assert "nobody sends" in written(page)


def test_the_line_round_who_is_selected_leaves_its_name_free(look, tmp_path):
    path = tmp_path / "two.toml"
    path.write_text(row_of("home", "far"))
    with beside(path, None) as address:
        page = look(address, script=WRITTEN)
        click(page, "far", has="switched off")
        page.evaluate(DRAWN)
        stage = page.locator("#stage").bounding_box()
        x, y = place(page, "far")
        x, y = x - stage["x"], y - stage["y"]
        words = [one for canvas in page.evaluate(WORDS_OF, "#stage canvas") for one in canvas]
        ((_, left, top, right, low),) = [one for one in words if one[0] == "far"]
        apart = max(left - x, x - right, 0) ** 2 + max(top - y, y - low, 0) ** 2
        assert apart**0.5 > 6 + 6 + 2.5  # a node, the line's middle, half of its width


def test_an_empty_plot_says_so_one_of_a_thing_is_one_and_nothing_that_runs_is_read_out(
    look, tmp_path
):
    path = tmp_path / "two.toml"
    path.write_text(row_of("home", "far"))
    with beside(path, None) as address:
        page = look(address, script=WRITTEN)
        expect(page.locator("#stage")).to_have_attribute(
            "aria-label", "Map of a row: 2 nodes, 1 link"
        )
        written = f"({WORDS_OF})('.plot canvas').flat().map(([text]) => text)"
        page.wait_for_function(f"() => {written}.includes('nothing yet')")
        page.wait_for_function(f"() => {written}.includes('1 node')")
        assert not page.evaluate(f"{written}.includes('1 nodes')")
        for running in ("#since output", "#recovery output", "#clock"):
            expect(page.locator(running)).to_have_attribute(
                "aria-live", "off"
            )  # else read for ever
