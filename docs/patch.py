"""Takes the picture of docs/firmware.md's quick start: a patch of firmware that has healed.

`python -m docs.patch` brings the quick start's scenario up on emulated boards, as its commands say,
waits on the page of `watch live` until the cut cable's cell has its way round, and writes
docs/images/firmware.png.
"""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
import tempfile
import time
from io import BytesIO
from pathlib import Path
from typing import Any

from PIL import Image
from playwright.sync_api import sync_playwright

from docs.tour import FINE, FOLDER
from innervate.live import status
from tests.browser.servers import MISSING, chromium, serving

PAGE = {"width": 1080, "height": 620}
TEXT = FOLDER.parent / "firmware.md"
CELL, FAR = "c0", 4  # whose cable is cut, and how far it then is from the PC
HEALED_S = 60


def scenario() -> str:
    """The scenario of the quick start."""
    return re.findall(r"```toml\n(.*?)```", TEXT.read_text(encoding="utf-8"), re.DOTALL)[0]


def healed(folder: Path) -> None:
    """Wait until the cell goes the long way round.

    Raises:
        TimeoutError: it does not.
    """
    until = time.monotonic() + HEALED_S
    while status.ask_one(folder / f"{CELL}.sock", {"do": "status"})["dist"] != FAR:
        if time.monotonic() > until:
            raise TimeoutError(f"{CELL} did not find its way round in {HEALED_S} s")
        time.sleep(0.1)


def picture(browser: Any, folder: Path) -> bytes:
    """The page, once the patch has healed."""
    os.environ["INNERVATE_RUN"] = str(folder)
    with serving("live") as address:
        page = browser.new_page(viewport=PAGE, device_scale_factor=FINE)
        page.goto(address)
        page.locator("#stage[aria-label]").wait_for()
        healed(folder)
        page.evaluate("() => new Promise((done) => setTimeout(done, 3000))")  # it was drawn
        page.mouse.move(0, 0)
        taken: bytes = page.screenshot()
        page.close()
    return taken


def main() -> int:
    """Take it."""
    path = chromium()
    if path is None:
        print(MISSING, file=sys.stderr)
        return 1
    with tempfile.TemporaryDirectory() as name, sync_playwright() as playwright:
        folder = Path(name)
        (folder / "patch.toml").write_text(scenario())
        words = ["live", "up", "patch.toml", "--firmware", "--folder", "run"]
        up = subprocess.Popen([sys.executable, "-m", "innervate.cli", *words], cwd=folder)
        browser = playwright.chromium.launch(executable_path=path, args=["--no-sandbox"])
        try:
            while not status.answers(folder / "run/pc.sock") and up.poll() is None:
                time.sleep(0.1)
            taken = Image.open(BytesIO(picture(browser, folder / "run")))
        finally:
            browser.close()
            up.send_signal(signal.SIGINT)
            up.wait()
    few = taken.convert("RGB").quantize(256, Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE)
    few.save(FOLDER / "firmware.png", optimize=True)
    print(f"firmware.png: {(FOLDER / 'firmware.png').stat().st_size / 1e3:.0f} kB")
    return 0


if __name__ == "__main__":
    sys.exit(main())
