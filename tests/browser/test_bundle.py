"""The committed bundle of the page is what its sources make, and keeps what the page promises."""

import hashlib
import re
import shutil
import subprocess
from pathlib import Path

import pytest

from innervate.plot import theme

ROOT = Path(__file__).resolve().parents[2]
PAGE = ROOT / "src" / "innervate" / "web" / "page"
STATIC = ROOT / "src" / "innervate" / "web" / "static"
SOURCES = sorted(path for path in PAGE.iterdir() if path.is_file())
LINES_MAX = 300
COLUMNS_MAX = 100


def fingerprint():
    """As build.mjs makes it."""
    made = hashlib.sha256()
    for path in SOURCES:
        made.update(path.name.encode() + b"\0" + path.read_bytes() + b"\0")
    return made.hexdigest()


@pytest.mark.parametrize("name", ["index.html", "page.css", "page.js"])
def test_the_bundle_is_of_these_sources(name):
    head = (STATIC / name).read_text(encoding="utf-8")[:400]
    found = re.search(r"sha256 ([0-9a-f]{64})", head)
    assert found is not None
    assert found[1] == fingerprint(), "out of date: run `make page`"


def test_building_again_gives_the_same_bytes(tmp_path):
    """Where its packages are installed; `make page-check` in CI installs them."""
    if shutil.which("node") and (PAGE / "node_modules").is_dir():
        subprocess.run(["node", str(PAGE / "build.mjs"), str(tmp_path)], check=True, timeout=60)
        built = {path.name: path.read_bytes() for path in tmp_path.iterdir()}
        assert built == {path.name: path.read_bytes() for path in STATIC.iterdir()}
    assert len(list(STATIC.iterdir())) == 5


def test_versions_are_pinned():
    lock = (PAGE / "package-lock.json").read_text(encoding="utf-8")
    package = (PAGE / "package.json").read_text(encoding="utf-8")
    for name, version in re.findall(r'"(d3-\w+|esbuild)": "([^"]+)"', package):
        assert re.fullmatch(r"\d+\.\d+\.\d+", version), name
        assert f'"{name}": "{version}"' in lock
    # Every package but the page itself is held to its content.
    assert lock.count('"integrity": "sha512-') == lock.count('"node_modules/')


def test_the_page_asks_nobody_else():
    """No address of another host, no code in attributes, no markup out of data."""
    for path in SOURCES:
        if path.suffix in {".html", ".css", ".js"}:
            text = path.read_text(encoding="utf-8")
            assert not re.search(r"https?://|//cdn|innerHTML|outerHTML|insertAdjacentHTML", text)
            assert not re.search(r"document\.write|\beval\(|new Function|style=|\son\w+=\"", text)


def test_licences_of_what_is_bundled_are_shipped():
    text = (STATIC / "LICENCES.txt").read_text(encoding="utf-8")
    for name in ("d3-zoom", "d3-selection", "d3-quadtree"):
        assert f"{name}\n" in text


def test_colours_are_those_of_the_reports():
    text = re.sub(r"\s+", "", (PAGE / "colours.css").read_text(encoding="utf-8"))
    light, dark = text.split(':root[data-theme="dark"]')
    blocks = re.findall(r":root\{color-scheme:[\w ]+;(.*?)\}", theme.variables())
    for block, where in zip([blocks[0]], [light], strict=True):
        assert all(word in where for word in block.split(";"))
    night = re.search(r"dark\)\{:root\{(.*?)\}", theme.variables())[1]
    assert all(word in dark for word in night.split(";"))


def test_sources_are_short():
    for path in SOURCES:
        if path.suffix in {".css", ".html", ".js", ".mjs"}:
            lines = path.read_text(encoding="utf-8").splitlines()
            assert len(lines) <= LINES_MAX, path.name
            assert max(map(len, lines)) <= COLUMNS_MAX, path.name
