"""How the page is laid out and drawn: phones, large screens, plots, the end of a run, the mouse."""

import re
from contextlib import ExitStack, suppress
from pathlib import Path

import pytest

from innervate.scenario import load
from tests.browser.servers import PHONE, SKIN, beside, click, expect, place, seek


def text_of(name):
    """A bundled scenario as it stands."""
    source = load(name).source
    return (Path(source.folder) / source.path).read_text()


CABLE = "p0 r0 c2 - pc.0"
CELL = "p0 r3 c3"
SHORT = SKIN.replace("duration_s = 60", "duration_s = 3") + "".join(
    f'[[event]]\nat_s = {at_s}\naction = "{action}"\ninterface = 1\n'
    for at_s, action in ((1, "cut"), (2, "restore"))
)
RING = """
kind = "radio"
duration_s = 5
stations = 20
[traffic]
kind = "saturated"
"""
SCENARIOS = {
    "skin": (SKIN, 0.1),
    "short": (SHORT, 0.5),
    "ring": (RING, 0.01),
    "field": (text_of("mesh-field"), 1),
    "legs": (text_of("icub-leg"), 0.1),
}
SIZES = [{"width": 1200, "height": 760}, {"width": 1920, "height": 1080}, PHONE]
# It has measured itself and drawn.
DRAWN = """() => new Promise((done) => {
  const after = (frames) => requestAnimationFrame(() => frames ? after(frames - 1) : done());
  after(3);
})"""
# What is written on canvases, as [text, x0, y0, x1, y1] in px of the canvas; the last drawing.
WRITTEN = """
window.written = new Map();
const put = CanvasRenderingContext2D.prototype.fillText;
CanvasRenderingContext2D.prototype.fillText = function (text, x, y) {
  const { width } = this.measureText(text);
  const left = x - { left: 0, start: 0, center: 0.5, right: 1 }[this.textAlign] * width;
  if (!window.written.has(this.canvas)) window.written.set(this.canvas, []);
  window.written.get(this.canvas).push([text, left, y - 6, left + width, y + 6]);
  return put.apply(this, arguments);
};
const clear = CanvasRenderingContext2D.prototype.clearRect;
CanvasRenderingContext2D.prototype.clearRect = function () {
  window.written.set(this.canvas, []);
  return clear.apply(this, arguments);
};
"""
WORDS_OF = """(selector) => {
  const canvases = [...document.querySelectorAll(selector)];
  return canvases.map((one) => (window.written.get(one) ?? []).filter(([text]) => text !== ""));
}"""


def box(page, selector):
    return page.locator(selector).bounding_box()


def hold(page, t_s):
    """Hold a network at a time; what is shown is of then."""
    expect(page.locator("#clock")).to_have_text(re.compile(r" s / "))  # the state has come
    page.locator("#speed").fill("4")  # slow, or it is over before it was looked at
    press = page.locator("#go")
    said = re.compile(rf"^{t_s:.6f} s")
    for _ in range(20):  # the network may come to its end while we reach for the button
        shown = press.inner_text()
        if shown != "Play":
            press.click()
            with suppress(AssertionError):  # the page was connecting anew: press again
                expect(press).not_to_have_text(shown, timeout=3_000)
            continue
        seek(page, t_s)
        expect(page.locator("#clock")).to_have_text(said)
        page.evaluate("() => new Promise((drawn) => setTimeout(drawn, 300))")  # panels follow
        if press.inner_text() == "Play" and said.match(page.locator("#clock").inner_text()):
            return
    raise AssertionError(f"it did not stay at {t_s} s: {page.locator('#clock').inner_text()}")


def end(page):
    """Bring a network to its end."""
    hold(page, 2.9)
    page.locator("#speed").fill("9")
    page.locator("#go").click()
    expect(page.locator("#go")).to_have_text("Replay")


@pytest.fixture(scope="module")
def served(tmp_path_factory):
    """Addresses by what is shown there: a server for each, for all tests of this file."""
    folder = tmp_path_factory.mktemp("design")
    with ExitStack() as open_:
        kept = {}

        def address(name):
            if name not in kept:
                text, speed = SCENARIOS[name]
                (folder / f"{name}.toml").write_text(text)
                kept[name] = open_.enter_context(beside(folder / f"{name}.toml", speed))
            return kept[name]

        yield address


@pytest.fixture
def skin(served):
    """A skin that tests leave as they found it."""
    return served("skin")


@pytest.fixture
def short(served):
    """A skin of three seconds, with a cut and its repair."""
    return served("short")


def test_a_phone_has_the_map_at_once_and_the_play_bar_always(look, skin):
    page = look(skin, PHONE, has_touch=True, is_mobile=True)
    assert box(page, "#stage")["y"] < 200
    for down in (0, 10_000):
        page.evaluate("(y) => scrollTo(0, y)", down)
        bar = box(page, "#transport")
        assert bar["y"] + bar["height"] <= PHONE["height"]
        assert bar["y"] > PHONE["height"] - 120
        for control in ("#go", "#step", "#seek", "#speed", "#clock"):
            assert 0 <= box(page, control)["x"] < PHONE["width"]
            assert box(page, control)["y"] >= bar["y"]
    last = box(page, "#events")
    assert last["y"] + last["height"] <= box(page, "#dock")["y"]  # nothing ends behind the bar


@pytest.mark.parametrize("size", [(844, 390), (667, 375)])
def test_a_phone_on_its_side_has_map_and_play_bar_in_sight_all_the_time(look, skin, size):
    width, height = size
    page = look(skin, {"width": width, "height": height}, has_touch=True, is_mobile=True)
    expect(page.locator("#state")).to_be_visible()
    page.locator("#tool").select_option("look")
    for down in (0, 10_000):
        page.evaluate("(y) => scrollTo(0, y)", down)
        stage, bar = box(page, "#stage"), box(page, "#transport")
        assert stage["y"] >= 0
        assert 0.75 * height < stage["y"] + stage["height"] <= bar["y"]
        assert stage["height"] > 0.75 * height
        assert bar["y"] + bar["height"] <= height
        assert bar["height"] < 70
        for control in ("#go", "#step", "#seek", "#speed", "#clock"):
            assert box(page, control)["x"] + box(page, control)["width"] <= width
    last = box(page, "#events")
    assert last["x"] >= stage["x"] + stage["width"]
    assert last["y"] + last["height"] <= bar["y"]
    assert page.evaluate("document.documentElement.scrollWidth") == width
    page.touchscreen.tap(*place(page, CELL))
    card = box(page, "#selection")
    assert stage["x"] + stage["width"] <= card["x"]
    assert card["y"] + card["height"] <= bar["y"]


CELLS = """() => {
  const one = document.querySelector("#stage canvas");
  const { data } = one.getContext("2d").getImageData(0, 0, one.width, one.height);
  return data.filter((value, i) => i % 4 === 3 && value).length;
}"""


def test_a_map_that_is_measured_anew_at_the_same_size_has_all_its_cells(look):
    with beside("setup-8", 0, held=True) as address:
        page = look(address, PHONE)
        page.wait_for_function(f"() => ({CELLS})() > 10_000")
        page.evaluate("document.querySelector('#stage').style.marginRight = '0.3px'")
        page.evaluate(DRAWN)
        assert page.evaluate(CELLS) > 10_000


# How many shapes the largest path had that was filled: time grows faster than they do.
FILLED = """
window.most = 0;
const close = Path2D.prototype.closePath;
Path2D.prototype.closePath = function () {
  this.shapes = (this.shapes ?? 0) + 1;
  return close.call(this);
};
const fill = CanvasRenderingContext2D.prototype.fill;
CanvasRenderingContext2D.prototype.fill = function (path) {
  window.most = Math.max(window.most, path?.shapes ?? 0);
  return fill.apply(this, arguments);
};
"""


def test_cells_are_filled_in_paths_of_a_few(look):
    with beside("setup-8", 0, held=True) as address:
        page = look(address, PHONE, script=FILLED)
        page.wait_for_function(f"() => ({CELLS})() > 10_000")
        assert 1 < page.evaluate("window.most") <= 20


def test_a_phone_shows_what_is_selected_above_the_play_bar(look, skin):
    page = look(skin, PHONE, has_touch=True, is_mobile=True)
    page.locator("#tool").select_option("look")
    page.evaluate("scrollTo(0, 0)")
    expect(page.locator("#state")).to_be_visible()  # it comes with the first figures, above the map
    before = box(page, "#stage")
    page.touchscreen.tap(*place(page, CELL))
    expect(page.locator("#selected-name")).to_have_text(CELL)
    sheet, bar = box(page, "#selection"), box(page, "#transport")
    assert sheet["y"] + sheet["height"] <= bar["y"]
    assert sheet["y"] >= before["y"] + before["height"]  # it hides nothing of the map
    assert box(page, "#stage") == before
    high, end = page.evaluate("""() => {  // at once: the next state brings other words
      document.getElementById("selected-facts").textContent = "field 7, ".repeat(99);
      const of = (id) => document.getElementById(id).getBoundingClientRect();
      return [of("selected-facts").height, of("selected-do").bottom];
    }""")
    assert high < 0.15 * PHONE["height"]  # the map stays, and the rest is scrolled to
    assert end < bar["y"]
    page.locator("#unselect").tap()
    expect(page.locator("#selection")).to_be_hidden()


def test_plots_have_a_time_axis_and_values_in_a_gutter(look, short):
    page = look(short, script=WRITTEN)
    hold(page, 2.5)
    for words in page.evaluate(WORDS_OF, ".plot canvas"):
        values = [one for one in words if one[3] < 46]
        times = [one for one in words if re.fullmatch(r"[\d.]+ m?s", one[0]) and one[1] > 30]
        assert "0" in [text for text, *_ in values]
        assert {"1 s", "2 s"} <= {text for text, *_ in times}
        assert all(left >= 0 for _, left, *_ in words)
        assert len(values) == 2
        assert overlapping(words) == []


def test_losses_and_returns_are_marked_also_for_who_comes_later(look, short):
    page = look(short)
    end(page)
    other = look(short)
    for one in (page, other):
        expect(one.locator("#log")).to_contain_text("put back")
        assert one.evaluate("innervate.marks()") == {"loss": [1], "return": [2]}
        expect(one.locator("#legend")).to_contain_text("put back")
    seek(page, 1.5)
    expect(page.locator("#go")).not_to_have_text("Replay")
    page.wait_for_function("() => innervate.marks().return.length === 0")
    assert page.evaluate("innervate.marks()")["loss"] == [1]


def test_the_end_is_said_and_replayed(look, short):
    page = look(short)
    end(page)
    expect(page.locator("#clock")).to_contain_text("end")
    expect(page.locator("#step")).to_be_disabled()
    page.locator("#speed").fill("4")  # slow, or it is over before it was looked at
    expect(page.locator("#speed-text")).to_have_text("0.02x")
    page.locator("#go").click()
    expect(page.locator("#go")).to_have_text("Pause")
    expect(page.locator("#clock")).to_have_text(re.compile(r"^[012]\.\d+ s"))
    page.keyboard.press("Space")
    expect(page.locator("#go")).to_have_text("Play")


def test_every_kind_of_frame_has_its_sample_in_the_legend(look, skin):
    page = look(skin)
    legend = page.locator("#legend")
    for words in ("beacon", "sample to the PC", "in plots: cut or switched off"):
        expect(legend).to_contain_text(words)


def test_a_cut_that_nobody_needed_says_so(look, skin):
    page = look(skin)
    for cable in ("p0 r2 c3 - p0 r2 c4", "p0 r4 c0 - p0 r4 c1", "p0 r1 c6 - p0 r1 c7"):
        click(page, cable, "link, cut")
        expect(page.locator("#recovery")).not_to_have_class("number open")
        said = page.locator("#recovery .more").inner_text()
        click(page, cable, "link, up")
        if "no cell lost its way" in said:
            return
    raise AssertionError("every one of these cables was on somebody's way")


def test_the_pc_is_no_cell(look, tmp_path):
    path = tmp_path / "restart.toml"
    event = '[[event]]\nat_s = 1\naction = "restart"\npc = true\n'
    path.write_text(SKIN.replace("duration_s = 60", "duration_s = 3") + event)
    with beside(path, 0.5) as address:
        page = look(address)
        hold(page, 2.0)
        said = "the PC restarted: no cell lost its way"
        expect(page.locator("#recovery .more")).to_have_text(said)


def test_the_mouse_is_told_what_lies_under_it_and_what_a_click_would_do(look, skin):
    page = look(skin)
    tip = page.locator("#tip")
    expect(tip).to_be_hidden()
    page.mouse.move(*place(page, CELL))
    expect(tip).to_contain_text(CELL)
    expect(tip).to_contain_text("through port")
    expect(tip).to_contain_text("a click kills it")
    page.mouse.move(*place(page, CABLE))
    expect(tip).to_contain_text("link, up")
    expect(tip).to_contain_text("a click cuts it")
    page.locator("#tool").select_option("look")
    page.mouse.move(*place(page, CELL))
    expect(tip).to_contain_text(CELL)
    expect(tip).not_to_contain_text("a click")
    page.mouse.move(2, 2)
    expect(tip).to_be_hidden()


def test_a_click_that_misses_the_middle_of_a_cable_does_not_cut_it(look, skin):
    page = look(skin)
    page.locator("#tool").select_option("look")
    (ax, ay), (bx, by) = place(page, "p0 r3 c3"), place(page, "p0 r3 c4")
    away = ((bx - ax) ** 2 + (by - ay) ** 2) ** 0.5
    for share, aside, hit in ((0.5, 0, True), (0.3, 0, False), (0.5, 0.2 * away, False)):
        page.mouse.click(ax + share * (bx - ax), ay + share * (by - ay) + aside)
        name = page.locator("#selected-name")
        wanted = "p0 r3 c3 - p0 r3 c4" if hit else re.compile(r"^p0 r\d c\d$")
        expect(name).to_have_text(wanted)


def test_a_large_screen_is_used(look, skin):
    page = look(skin, SIZES[0])
    font = "(one) => parseFloat(getComputedStyle(one).fontSize)"
    small, large = [], []
    for size, seen in zip(SIZES, (small, large), strict=False):
        page.set_viewport_size(size)
        page.evaluate(DRAWN)
        for selector in ("#stage", "#plots", "#numbers", "#log"):
            seen.append(box(page, selector)["width"])
        seen.append(
            [page.locator(one).evaluate(font) for one in ("body", "#since output", "#legend")]
        )
    *widths, fonts = zip(small, large, strict=True)
    assert all(wide > 1.4 * narrow for narrow, wide in widths)
    assert all(there > here for here, there in zip(*fonts, strict=True))
    assert page.evaluate("document.documentElement.scrollHeight") == 1080


@pytest.mark.parametrize(("what", "t_s", "names"), [
    ("ring", 0.05, {str(i) for i in range(20)}),
    ("field", 30.0, {"n0 gateway", "n29 robot outside"}),  # nodes are off, too
    ("legs", 0.2, {"0", "1"}),
])  # fmt: skip
def test_names_on_maps_keep_apart_and_inside(look, served, what, t_s, names):
    page = look(served(what), SIZES[0], script=WRITTEN)
    hold(page, t_s)
    check_names(page, names)
    for size in SIZES[1:]:
        page.evaluate("window.written.clear()")  # what is found then was drawn in this size
        page.set_viewport_size(size)
        page.evaluate(DRAWN)
        check_names(page, names)


def check_names(page, names):
    """What is written on the map keeps apart from all else that is, and inside."""
    canvases = page.evaluate(WORDS_OF, "#stage canvas")
    written = [(str(text), *at) for words in canvases for text, *at in words]
    words = [one for one in written if len(one[0]) > 1 or one[0].isdigit()]  # no marks of states
    assert {text for text, *_ in words} >= names
    assert overlapping(words) == []
    stage = box(page, "#stage")
    outside = [
        text for text, left, top, right, low in words
        if left < 0 or right > stage["width"] or top < 0 or low > stage["height"]
    ]  # fmt: skip
    assert outside == []


def overlapping(words):
    """Pairs of texts that lie on each other."""
    return [
        (a[0], b[0])
        for i, a in enumerate(words)
        for b in words[:i]
        if a[1] < b[3] and b[1] < a[3] and a[2] < b[4] and b[2] < a[4]
    ]
