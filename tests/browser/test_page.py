"""The page of `innervate watch` in a browser: what a user does, and what is seen of it."""

import re
import socket

from tests.browser.servers import PHONE, SKIN, click, expect, facts, place, seek, serving

CABLE = "p0 r0 c2 - pc.0"
OTHER = "p0 r2 c3 - p0 r2 c4"
DURATION = re.compile(r"^\d+(\.\d+)? m?s$")
STOPS_MAX = 40  # of the Tab key


def text(page, selector):
    return page.locator(selector).inner_text()


def test_it_shows_the_network_and_asks_nobody_else(look, skin):
    page = look(skin)
    assert page.title() == "a <b>small</b> skin - innervate watch"
    expect(page.locator("#name")).to_have_text("a <b>small</b> skin")  # a name is no markup
    expect(page.locator("#connection")).to_have_text("connected")
    expect(page.locator("#unconnected .more")).to_have_text("of 48 cells")
    expect(page.locator(".plot")).to_have_count(4)
    asked = page.evaluate("performance.getEntriesByType('resource').map((one) => one.name)")
    assert asked
    assert all(address.startswith(skin.partition("?")[0]) for address in asked)


def test_a_click_cuts_a_cable_and_the_next_heals_it(look, fresh):
    page = look(fresh)
    click(page, CABLE, "link, cut")
    expect(page.locator("#recovery")).to_have_class("number done")
    expect(page.locator("#recovery output")).to_have_text(DURATION)
    expect(page.locator("#recovery .more")).to_contain_text("interface 0")
    expect(page.locator("#since output")).to_have_text(DURATION)
    expect(page.locator("#log")).to_contain_text("cable to interface 0 cut")
    click(page, CABLE, "link, up")


def test_a_click_kills_a_cell_and_the_next_revives_it(look, skin):
    page = look(skin)
    click(page, "p0 r3 c3", "switched off")
    click(page, "p0 r3 c3", has="through port")


def test_a_command_is_sent_to_the_selected_cell(look, skin):
    page = look(skin)
    page.locator("#tool").select_option("look")
    click(page, "p0 r4 c1")
    page.locator("#command summary").click()
    page.locator("#command-code").fill("3")
    page.locator("#command-value").fill("500")
    page.locator("#command-send", has_text="Send to this cell").click()
    expect(page.locator("#log")).to_contain_text("came to p0 r4 c1 after")
    expect(facts(page)).to_contain_text("came")
    page.locator("#command-code").fill("256")
    page.locator("#command-send").click()  # refused by the field itself
    expect(page.locator("#log")).not_to_contain_text("not a command")


def test_a_click_touches_a_cell_and_the_pc_receives_it(look, fresh):
    page = look(fresh)
    page.locator("#tool").select_option("touch")
    page.locator("#colour").select_option("touch")
    click(page, "p0 r4 c1", has="touched")
    click(page, "p0 r4 c1")
    expect(facts(page)).not_to_contain_text("touched")
    page.locator("#selected-do button", has_text="Kill").click()
    expect(facts(page)).to_have_text("switched off")
    page.locator("#selected-do button", has_text="Revive").click()
    expect(facts(page)).to_contain_text("through port")
    click(page, OTHER)  # the middle of a cable: it is one of its cells that is touched
    expect(facts(page)).to_contain_text("touched")
    expect(page.locator("#selected-name")).not_to_contain_text(" - ")
    page.locator("#selected-do button", has_text="Kill").wait_for()
    assert page.locator("#log").get_by_text("cable").count() == 0
    click(page, OTHER)
    expect(facts(page)).not_to_contain_text("touched")


def test_the_state_of_the_network_is_one_line(look, fresh):
    page = look(fresh)
    level, line = page.locator("#level"), page.locator("#headline")
    expect(level).to_have_text("✓ ok")
    expect(line).to_have_text(
        "Every cell has a way to the PC, and no sample was lost after the start."
    )
    click(page, "p0 r3 c3")
    expect(level).to_have_text("! degraded")
    expect(line).to_contain_text("1 of 48 cells (p0 r3 c3) is switched off")
    spoken = page.locator("#state-spoken[role=status]")
    expect(spoken).to_contain_text("degraded: 1 of 48 cells (p0 r3 c3) is switched off")
    click(page, "p0 r2 c6")
    expect(spoken).to_contain_text("still degraded; cell p0 r2 c6 switched off: ")
    expect(spoken).to_contain_text("2 of 48 cells (p0 r2 c6, p0 r3 c3) are switched off")
    for cell in ("p0 r2 c6", "p0 r3 c3"):
        click(page, cell, has="through port")
    click(page, CABLE)
    click(page, "p0 r5 c6 - pc.1")
    expect(level).to_have_text("✕ down")
    expect(page.locator("#unconnected .more")).to_have_text("of 48 cells; cut off")
    expect(page.locator("#recovery output")).to_have_text("\u2013")
    expect(page.locator("#recovery .more")).to_contain_text("no cell is left that could have a way")
    expect(page.locator("#recovery")).to_have_class("number bad")
    for cable in (CABLE, "p0 r5 c6 - pc.1"):
        click(page, cable)
    expect(page.locator("#unconnected output")).to_have_text("0")
    expect(level).to_have_text("! degraded")  # samples were lost


def test_keys_alone_cut_and_heal(look, skin):
    page = look(skin)
    for _ in range(STOPS_MAX):
        page.keyboard.press("Tab")
        if page.evaluate("document.activeElement.id") == "stage":
            break
    for key in ("ArrowRight", "ArrowDown", "Shift+ArrowRight"):
        page.keyboard.press(key)
    expect(page.locator("#selected-name")).to_contain_text(" - ")
    spoken = page.locator("#spoken")
    assert spoken.inner_text().endswith("link, up")
    page.keyboard.press("Enter")
    expect(spoken).to_have_text(re.compile(r".*link, cut$"))
    page.locator("#tool").select_option("touch")
    page.locator("#stage").focus()
    page.keyboard.press("Enter")  # a finger heals nothing either
    page.locator("#tool").select_option("cut")
    page.locator("#stage").focus()
    page.keyboard.press("Enter")
    expect(spoken).to_have_text(re.compile(r".*link, up$"))


def test_every_control_has_a_name_and_is_reached_by_tab(look, skin):
    page = look(skin)
    click(page, OTHER, "link, cut")
    found = {}
    for _ in range(STOPS_MAX):
        page.keyboard.press("Tab")
        one = page.evaluate(
            "() => { const e = document.activeElement; return [e.id || e.innerText, "
            "e.getAttribute('aria-label') || e.labels?.[0]?.innerText || e.innerText, "
            "getComputedStyle(e).outlineStyle]; }"
        )
        found[one[0]] = one[1:]
    wanted = page.evaluate(
        "[...document.querySelectorAll('main button, main input, main select, header button')]"
        ".filter((e) => e.offsetParent && !e.disabled).map((e) => e.id || e.innerText)"
    )
    assert set(wanted) <= set(found)
    assert all(name.strip() for name, _ in found.values())
    assert all(outline == "solid" for one, (_, outline) in found.items() if one in wanted)
    click(page, OTHER, "link, up")


def test_the_tab_key_goes_as_the_eye_does(look, skin):
    """From the tools above the map to the map, and on to what stands below it."""
    page = look(skin)
    tops = page.evaluate(
        "() => [...document.querySelectorAll('#view select, #view button, #stage')]"
        ".filter((e) => e.offsetParent).map((e) => e.getBoundingClientRect().top)"
    )
    assert len(tops) > 4
    assert tops == sorted(tops)


READ_ALOUD = """() => {
  const all = (selector) => [...document.querySelectorAll(selector)];
  const name = (one) => one.id || one.className || one.tagName;
  const words = (one) => one.innerText.trim();
  const place = "header, main, section[aria-label], dialog, [role=alert]";
  return {
    "items of no list": all("li").filter((one) => one.parentElement.matches("[role]")).map(words),
    "names without what is seen": all("button[aria-label]")
      .filter((one) => /\\w/.test(words(one)) && !one.ariaLabel.includes(words(one))).map(name),
    "outside of every landmark": all("body *")
      .filter((one) => one.offsetParent && words(one) && !one.closest(place)).map(name),
    "scrolled by the mouse alone": all("body *")
      .filter((one) => /auto|scroll/.test(getComputedStyle(one).overflowY)
        && one.scrollHeight > one.clientHeight + 1 && one.tabIndex < 0).map(name),
  };
}"""


def test_programs_that_read_aloud_find_lists_names_and_places(look, skin):
    page = look(skin, {"width": 1160, "height": 600})  # plots do not fit
    click(page, OTHER)  # the log has a line, and the card is there
    expect(facts(page)).to_have_text("link, cut")
    found = page.evaluate(READ_ALOUD)
    click(page, OTHER, "link, up")
    assert found == {what: [] for what in found}


def test_pause_step_and_speed(look, skin):
    page = look(skin)
    page.keyboard.press("Space")
    expect(page.locator("#go")).to_have_text("Play")
    before = text(page, "#clock")
    page.locator("#step").click()
    expect(page.locator("#clock")).not_to_have_text(before)
    page.locator("#speed").focus()
    page.keyboard.press("ArrowLeft")
    expect(page.locator("#speed-text")).to_have_text("0.05x")
    page.locator("#stage").focus()
    page.keyboard.press("]")
    expect(page.locator("#speed-text")).to_have_text("0.1x")
    page.locator("#go").click()
    expect(page.locator("#go")).to_have_text("Pause")


def test_scrubbing_leads_back(look, skin):
    page = look(skin)
    page.locator("#go").click()
    for t_s in (2.0, 0.5, 30.0):  # at 30 s all that other tests did has been done again
        seek(page, t_s)
        expect(page.locator("#clock")).to_have_text(re.compile(rf"^{t_s:.6f} s"))
    page.locator("#go").click()
    expect(page.locator("#go")).to_have_text("Pause")


def test_two_pages_see_the_same(look, skin):
    one, other = look(skin), look(skin, colours="dark")
    one.locator("#go").click()
    expect(other.locator("#go")).to_have_text("Play")
    click(other, OTHER)
    click(one, "p0 r2 c3")
    expect(facts(other)).to_have_text("link, off at one end")
    one.locator("#selected-do button", has_text="Revive").click()
    expect(facts(other)).to_have_text("link, cut")
    expect(one.locator("#clock")).to_have_text(text(other, "#clock"))
    click(other, OTHER, "link, up")
    other.locator("#go").click()
    expect(one.locator("#go")).to_have_text("Pause")


def test_dark_as_the_system_has_it_or_as_chosen(look, skin):
    page = look(skin, colours="dark")
    ground = "() => getComputedStyle(document.documentElement).backgroundColor"
    assert page.evaluate(ground) == "rgb(18, 22, 28)"
    page.locator("#theme").click()
    expect(page.locator("#theme")).to_have_text("Theme: light")
    assert page.evaluate(ground) == "rgb(255, 255, 255)"
    page.reload()
    expect(page.locator("#theme")).to_have_text("Theme: light")
    page.keyboard.press("t")
    assert page.evaluate(ground) == "rgb(18, 22, 28)"


def test_a_phone_shows_it_all(look, skin):
    page = look(skin, PHONE, has_touch=True, is_mobile=True)
    assert page.evaluate("document.documentElement.scrollWidth") == PHONE["width"]
    page.touchscreen.tap(*place(page, OTHER))
    expect(facts(page)).to_have_text("link, cut")
    page.locator("#selected-do button").tap()
    expect(facts(page)).to_have_text("link, up")
    assert page.evaluate("document.documentElement.scrollWidth") == PHONE["width"]


def test_a_tap_on_what_is_smaller_than_a_finger_only_selects(look, skin):
    page = look(skin, {"width": 200, "height": 1600}, has_touch=True)
    page.touchscreen.tap(*place(page, "p0 r2 c3"))
    expect(page.locator("#selected-name")).to_have_text("p0 r2 c3")
    page.locator("#selected-do button", has_text="Kill").tap()
    expect(facts(page)).to_have_text("switched off")
    page.locator("#selected-do button", has_text="Revive").tap()
    expect(facts(page)).to_contain_text("through port")


def test_the_scenario_is_saved_with_what_was_done(look, fresh):
    page = look(fresh)
    click(page, OTHER, "link, cut")
    with page.expect_download() as told:
        page.locator("#save").click()
    assert told.value.suggested_filename == "a-b-small-b-skin.toml"
    saved = told.value.path().read_text()
    assert 'name = "a <b>small</b> skin"' in saved
    assert 'action = "cut"' in saved
    click(page, OTHER, "link, up")


def test_keys_are_listed(look, skin):
    page = look(skin)
    page.keyboard.press("?")
    expect(page.locator("#help")).to_be_visible()
    assert "cut or heal the link" in text(page, "#keys")
    expect(page.locator("#keys dd", has_text="pause or go on")).to_be_visible()
    expect(page.locator("#keys dd", has_text="next colouring")).to_be_visible()
    page.keyboard.press("Escape")
    expect(page.locator("#help")).to_be_hidden()


def test_an_address_without_the_token_says_so(look, skin, browser):
    page = browser.new_page()
    page.goto(skin.partition("?")[0])
    expect(page.locator("#lost")).to_contain_text("refuses this address")
    page.close()


def test_the_server_goes_and_comes_back(look, tmp_path):
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = free.getsockname()[1]
    path = tmp_path / "skin.toml"
    path.write_text(SKIN)
    with serving(path, port=port) as address:
        page = look(address)
        expect(page.locator("#lost")).to_be_hidden()
    expect(page.locator("#lost")).to_contain_text("lost. Trying again")
    expect(page.locator("#log")).to_contain_text("the server was stopped")
    with serving(path, port=port):
        expect(page.locator("#lost")).to_be_hidden()
        expect(page.locator("#connection")).to_have_text("connected")
