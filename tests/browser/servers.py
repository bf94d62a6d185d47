"""Servers to look at: `innervate watch` as a user starts it, or a page served by a thread, and what
a user does to it."""

import asyncio
import os
import re
import shutil
import signal
import subprocess
import sys
import threading
from concurrent.futures import Future
from contextlib import contextmanager

import pytest

from innervate import scenario
from innervate.web.messages import Pause
from innervate.web.serve import serving as served
from innervate.web.simulated import Simulated

TOKEN = "a-token-of-the-tests"
WAIT_MS = 20_000
# The headless shell draws the same, and takes a third less time: it has no window around the page.
BROWSERS = ("chromium-headless-shell", "chromium", "chromium-browser", "google-chrome")
MISSING = "Chromium is missing (Debian, Ubuntu: apt install chromium-headless-shell)"
START_S = 240  # the first simulation of a kind is compiled
WIDE = {"width": 1280, "height": 800}
PHONE = {"width": 360, "height": 740}
SKIN = """
kind = "skin"
name = "a <b>small</b> skin"
duration_s = 60
[[patch]]
columns = 8
rows = 6
[[interface]]
row = 0
column = 2
[[interface]]
row = 5
column = 6
[protocol]
updates = "wave"
[data]
rate_hz = 50
"""


def chromium():
    """The path of this machine's Chromium, or None."""
    return next(filter(None, map(shutil.which, BROWSERS)), None)


@contextmanager
def serving(what, *options, port=0):
    """`innervate watch` as a process; gives the address that it printed."""
    command = [sys.executable, "-m", "innervate.cli", "watch", str(what), "--port", str(port)]
    process = subprocess.Popen(
        [*command, *map(str, options)], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
        env=os.environ | {"INNERVATE_WATCH_TOKEN": TOKEN},
    )  # fmt: skip
    said = []
    late = threading.Timer(START_S, process.kill)
    late.start()
    try:
        for line in process.stdout:
            said.append(line)
            if found := re.search(r"http://\S+", line):
                late.cancel()
                yield found[0]
                break
        else:
            pytest.fail(f"innervate watch ended: {''.join(said)}")
    finally:
        late.cancel()
        process.send_signal(signal.SIGINT)
        process.wait(timeout=20)
        process.stdout.close()


@contextmanager
def beside(path, speed, held=False, settings=()):
    """A scenario's page as `watch` serves it, by a thread of this process: its loops are loaded
    once; gives the address. Held at its beginning, it needs no loop."""
    source = Simulated(scenario.plan(scenario.load(str(path), settings)), speed)
    if held:
        source.do(Pause())
    else:
        source.prepare()
    told = Future()

    async def serve():
        over = asyncio.Event()
        async with served(source) as one:
            told.set_result((one.address, asyncio.get_running_loop(), over))
            await over.wait()

    thread = threading.Thread(target=asyncio.run, args=(serve(),))
    thread.start()
    address, loop, over = told.result(WAIT_MS / 1000)
    try:
        yield address
    finally:
        loop.call_soon_threadsafe(over.set)
        thread.join()


def place(page, name):
    """Where on the page a node or link is, by its name, once it stays there.

    Panels that fill move the map; a few frames without a move, and it has found its place.
    """
    return page.evaluate(
        """async name => {
          let last = null, same = 0;
          while (same < 5) {
            await new Promise(requestAnimationFrame);
            const at = innervate.at(name);
            same = last && at[0] === last[0] && at[1] === last[1] ? same + 1 : 0;
            last = at;
          }
          return last;
        }""",
        name,
    )


def click(page, name, says=None, has=None):
    """Click a node or link; its card then says these words, or has them among others."""
    page.mouse.click(*place(page, name))
    if says is not None:
        expect(facts(page)).to_have_text(says)
    if has is not None:
        expect(facts(page)).to_contain_text(has)


def facts(page):
    """What the card of the selected node or link says."""
    return page.locator("#selected-facts")


def expect(locator):
    """Playwright's `expect`, for machines that have other work, too."""
    from playwright import sync_api

    sync_api.expect.set_options(timeout=WAIT_MS)
    return sync_api.expect(locator)


def seek(page, t_s):
    """Let go of the time slider at a time: without the preview while it is in hand."""
    page.locator("#seek").evaluate(
        "(seek, t) => { seek.value = t; seek.dispatchEvent(new Event('change')); }", t_s
    )
