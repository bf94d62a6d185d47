"""The page of `watch` in headless Chromium: frames a second while a skin runs before its eyes.

The skin is slowed down so far that all frames on the cables are drawn on their way, the most that
there is to draw; the server simulates on the same machine meanwhile.
"""

import tempfile
from pathlib import Path

from innervate import scenario
from tests.browser.servers import chromium, serving

CELLS = {1_000: (40, 25), 4_000: (80, 50)}
SPEED = 0.02
SECONDS = 8
NOW = "({...innervate, at: null, seconds: performance.now() / 1000})"
SIZE = {"width": 1280, "height": 800}


def measure(cells):
    """Frames and states a second, and how long the slowest of the last took to draw.

    None where Chromium is missing.
    """
    path = chromium()
    if path is None:
        return None
    from playwright.sync_api import sync_playwright

    columns, rows = CELLS[cells]
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        file = Path(folder) / "page.toml"
        ports = [{"row": row, "column": columns // 3} for row in (0, rows - 1)]
        keys = {"kind": "skin", "name": "page", "duration_s": 60, "interface": ports,
                "patch": [{"columns": columns, "rows": rows}],
                "protocol": {"updates": "wave", "max_depth": 120}}  # fmt: skip
        file.write_text(scenario.dump(scenario.from_dict(keys)))
        browser = playwright.chromium.launch(executable_path=path, args=["--no-sandbox"])
        with serving(file, "--speed", SPEED) as address:
            page = browser.new_page(viewport=SIZE)
            page.goto(address)
            page.locator("#stage[aria-label]").wait_for()
            first = page.evaluate(NOW)
            page.evaluate(f"() => new Promise((done) => setTimeout(done, {1000 * SECONDS}))")
            last = page.evaluate(NOW)
        browser.close()
    seconds = last["seconds"] - first["seconds"]
    return {
        "frames_per_s": (last["frames"] - first["frames"]) / seconds,
        "states_per_s": (last["states"] - first["states"]) / seconds,
        "slowest_ms": last["slowest_ms"],
    }
