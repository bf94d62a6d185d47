"""A browser, and servers that it can look at: `innervate watch` as a user starts it."""

import os
import shutil
from contextlib import contextmanager
from pathlib import Path

import pytest

from tests.browser.servers import SKIN, WIDE, serving

BROWSERS = ("chromium", "chromium-browser", "google-chrome")


@pytest.fixture(scope="module")  # while it is open its event loop runs, in which no other may run
def browser():
    sync_api = pytest.importorskip("playwright.sync_api", reason="playwright is missing")
    path = next(filter(None, map(shutil.which, BROWSERS)), None)
    if path is None:
        pytest.skip("Chromium is missing (Debian, Ubuntu: apt install chromium)")
    with sync_api.sync_playwright() as playwright:
        started = playwright.chromium.launch(executable_path=path, args=["--no-sandbox"])
        yield started
        started.close()


@pytest.fixture
def look(browser, request):
    """A function that opens a page; what it logged as an error fails the test.

    INNERVATE_SHOTS names a folder for a picture of every page as its test left it.
    """
    contexts, wrong = [], []
    folder = Path(os.environ["INNERVATE_SHOTS"]) if "INNERVATE_SHOTS" in os.environ else None
    if folder is not None:
        folder.mkdir(parents=True, exist_ok=True)

    def opened(address, size=WIDE, colours="light", **options):
        context = browser.new_context(viewport=size, color_scheme=colours, **options)
        contexts.append(context)
        page = context.new_page()
        page.set_default_timeout(20_000)
        page.on("pageerror", lambda error: wrong.append(str(error)))
        page.goto(address)
        page.locator("#stage[aria-label]").wait_for()
        return page

    yield opened
    for number, context in enumerate(contexts):
        for page in context.pages if folder is not None else ():
            page.screenshot(path=folder / f"{request.node.name}-{number}.png", full_page=True)
        context.close()
    assert wrong == []


@contextmanager
def small_skin(folder):
    """The address of a small skin, slowed down ten times."""
    path = folder / "skin.toml"
    path.write_text(SKIN)
    with serving(path, "--speed", 0.1) as address:
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
