"""A browser, and servers that it can look at."""

import os
from contextlib import contextmanager
from functools import cache
from pathlib import Path

import pytest

from tests.browser.servers import MISSING, SKIN, WIDE, beside, chromium


@pytest.fixture(scope="module")  # while it is open its event loop runs, in which no other may run
def browser():
    sync_api = pytest.importorskip("playwright.sync_api", reason="playwright is missing")
    path = chromium()
    if path is None:
        pytest.skip(MISSING)
    with sync_api.sync_playwright() as playwright:
        started = playwright.chromium.launch(executable_path=path, args=["--no-sandbox"])
        yield started
        started.close()


@cache
def blank(browser, device, number):
    """A page for one test after the other: a new one takes four times as long to open, of a new
    context eight. Pages of one test are of several contexts: behind another, one would hardly draw.
    """
    return browser.new_context(**dict(device)).new_page()


@pytest.fixture
def look(browser, request):
    """A function that opens a page; what it logged as an error fails the test.

    INNERVATE_SHOTS names a folder for a picture of every page as its test left it.
    """
    pages, kept, wrong = [], [], []
    folder = Path(os.environ["INNERVATE_SHOTS"]) if "INNERVATE_SHOTS" in os.environ else None
    if folder is not None:
        folder.mkdir(parents=True, exist_ok=True)

    def noted(error):
        wrong.append(str(error))

    def opened(address, size=WIDE, colours="light", script=None, **options):
        page = blank(browser, tuple(options.items()), len(pages))
        if script:
            page = page.context.new_page()
            page.add_init_script(script)
        else:
            kept.append(page)
        pages.append(page)
        page.set_viewport_size(size)
        page.emulate_media(color_scheme=colours)
        page.set_default_timeout(20_000)
        page.on("pageerror", noted)
        page.goto(address)
        page.locator("#stage[aria-label]").wait_for()
        return page

    yield opened
    for number, page in enumerate(pages):
        if folder is not None:
            page.screenshot(path=folder / f"{request.node.name}-{number}.png", full_page=True)
        page.evaluate("localStorage.clear()")
        page.remove_listener("pageerror", noted)
        if page in kept:
            page.goto("about:blank")
            page.mouse.move(0, 0)
        else:
            page.close()
    assert wrong == []


@contextmanager
def small_skin(folder):
    """The address of a small skin, slowed down ten times."""
    path = folder / "skin.toml"
    path.write_text(SKIN)
    with beside(path, 0.1) as address:
        yield address


@pytest.fixture(scope="module")
def skin(tmp_path_factory):
    """One for all tests of a file, which leave it as they found it; its log has what they did."""
    with small_skin(tmp_path_factory.mktemp("skin")) as address:
        yield address


@pytest.fixture
def fresh(tmp_path):
    """One that nobody else changes or has changed."""
    with small_skin(tmp_path) as address:
        yield address
