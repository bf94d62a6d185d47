"""Takes the pictures of docs/watch-tour.md and of the README's head, in Chromium.

`python -m docs.tour [NAME ...]` starts `innervate watch` for each picture, brings the network to a
moment by its own controls, and writes docs/images/watch-NAME.png.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from contextlib import suppress
from io import BytesIO
from pathlib import Path
from typing import Any

from PIL import Image
from playwright.sync_api import expect, sync_playwright

from tests.browser.servers import MISSING, PHONE, chromium, click, seek, serving

FOLDER = Path(__file__).resolve().parent / "images"
FINE = 1.5  # px of the picture per px of the page
PAGE = {"width": 1160, "height": 760}
WAIT_MS = 60_000
SOON_MS = 3_000


def at(page: Any, t_s: float) -> None:
    """Hold the network at a time."""
    press = page.locator("#go")
    while (shown := press.inner_text()) != "Play":
        if shown == "Replay":  # a short one may come to its end before it is held
            seek(page, 0)
        else:
            press.click()
        with suppress(AssertionError):  # the button was "Replay" when it was pressed
            expect(press).not_to_have_text(shown, timeout=SOON_MS)
    seek(page, t_s)
    expect(page.locator("#clock")).to_contain_text(f"{t_s:.6f} s", timeout=WAIT_MS)


def skin(page: Any) -> None:
    """A cable is cut by a click; 16 ms later the way back spreads."""
    at(page, 1.0)
    click(page, "p0 r16 c7 - pc.1")
    expect(page.locator("#selected-facts")).to_have_text("link, cut")
    page.locator("#speed").fill("2")
    at(page, 1.016)


def touch(page: Any) -> None:
    """What the PC receives of a touch that moves."""
    page.locator("#colour").select_option("touch")
    at(page, 2.6)


def radio(page: Any) -> None:
    """Ten stations that collided put themselves in order."""
    page.locator("#speed").fill("4")
    at(page, 0.16)


def mesh(page: Any) -> None:
    """Eight nodes died, a robot is outside, the alarm is there."""
    at(page, 27.1)


def phone(page: Any) -> None:
    """The same on a phone."""
    at(page, 1.0)
    click(page, "p0 r8 c6")
    at(page, 1.02)


Moment = Callable[[Any], None]
# name: (scenario, moment, size, colours)
PICTURES: dict[str, tuple[str, Moment, dict[str, int], str]] = {
    "skin": ("demo", skin, PAGE, "light"),
    "touch": ("demo", touch, PAGE, "dark"),
    "radio": ("radio-disaster", radio, PAGE, "light"),
    "mesh": ("mesh-field", mesh, PAGE, "light"),
    "phone": ("demo", phone, PHONE, "dark"),
}


def take(browser: Any, name: str) -> int:
    """Take one picture; its size in bytes."""
    what, moment, size, colours = PICTURES[name]
    with serving(what) as address:
        page = browser.new_page(viewport=size, color_scheme=colours, device_scale_factor=FINE)
        page.goto(address)
        page.locator("#stage[aria-label]").wait_for()
        moment(page)
        page.locator("#log").evaluate("list => list.scrollTo(0, list.scrollHeight)")
        page.evaluate("scrollTo(0, 0)")
        page.mouse.move(0, 0)
        page.evaluate("() => new Promise((done) => setTimeout(done, 500))")  # numbers have come
        taken = Image.open(BytesIO(page.screenshot()))
        page.close()
    path = FOLDER / f"watch-{name}.png"
    few = taken.convert("RGB").quantize(256, Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE)
    few.save(path, optimize=True)
    return path.stat().st_size


def main(names: list[str]) -> int:
    """Take all pictures, or those that are named."""
    path = chromium()
    if path is None:
        print(MISSING, file=sys.stderr)
        return 1
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=path, args=["--no-sandbox"])
        for name in names or PICTURES:
            print(f"watch-{name}.png: {take(browser, name) / 1e3:.0f} kB")
        browser.close()
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
