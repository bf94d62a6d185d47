"""The documentation as a site: `mkdocs.yml` is strict, so a link that leads nowhere fails."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

import innervate
from innervate.cli.app import app
from tests.fixtures.once import made_once

ROOT = Path(__file__).resolve().parents[2]


def build(folder, config):
    return subprocess.run(
        [sys.executable, "-m", "mkdocs", "build", "--config-file", config, "-d", folder],
        env=os.environ | {"NO_MKDOCS_2_WARNING": "1"},
        capture_output=True,
        text=True,
        check=False,
    )


def make(folder):
    done = build(folder, ROOT / "mkdocs.yml")
    assert done.returncode == 0, done.stderr


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    return made_once(tmp_path_factory, "site", make)  # or tests/ahead.py has made it


def test_every_page_is_there_and_every_link_leads_somewhere(site):
    for page in (ROOT / "docs").rglob("*.md"):
        assert (site / page.relative_to(ROOT / "docs").with_suffix(".html")).is_file(), page.name


def test_every_example_says_what_it_shows(site):
    said = (site / "examples" / "index.html").read_text(encoding="utf-8")
    told = dict(re.findall(r'<li><a href="[^"]*">([^<]*)</a>: ([^<]{20,200}[.?])</li>', said))
    assert told["beacon-rate.toml"] == "Which beacon rate is worth its bandwidth?"
    assert set(told) == {path.name for path in (ROOT / "examples").iterdir() if path.is_file()}


def test_every_command_is_described(site):
    said = (site / "commands.html").read_text(encoding="utf-8")
    for name in app:
        if not name.startswith("-"):
            assert f'id="innervate-{name}"' in said, name


def test_the_python_page_has_signatures_units_and_errors(site):
    said = (site / "api.html").read_text(encoding="utf-8")
    for words in ("duration_us", "InvariantBroken", "in place of the scenario", "Raises"):
        assert words in said


def test_nothing_is_fetched_from_elsewhere(site):
    for page in site.glob("*.html"):
        text = page.read_text(encoding="utf-8")
        assert not re.findall(r'<(?:script|img|link)[^>]*="https?:[^>]*>', text), page.name


def test_a_broken_link_fails(tmp_path):
    config = (ROOT / "mkdocs.yml").read_text(encoding="utf-8")
    (tmp_path / "docs").mkdir()
    (tmp_path / "docs" / "index.md").write_text("# One\n\n[nowhere](other.md)\n")
    before, rest = config.split("\nplugins:")
    checks = rest[rest.index("\nvalidation:") : rest.index("\nmarkdown_extensions:")]
    (tmp_path / "mkdocs.yml").write_text(f"{before}\nplugins: []{checks}")
    done = build(tmp_path / "site", tmp_path / "mkdocs.yml")
    assert done.returncode == 1
    assert "other.md" in done.stderr


def test_the_citation_names_this_version():
    text = (ROOT / "CITATION.cff").read_text(encoding="utf-8")
    assert re.search(r"^version: (.*)$", text, re.MULTILINE)[1] == innervate.__version__


def test_the_paper_cites_what_its_list_has():
    text, given = ((ROOT / "paper" / name).read_text("utf-8") for name in ("paper.md", "paper.bib"))
    cited = re.findall(r"@(\w+)", text)
    assert set(cited) == set(re.findall(r"^@\w+\{(\w+),$", given, re.MULTILINE))
    (title,) = re.findall(r"^title: '(.*)'$", text, re.MULTILINE)
    assert title in (ROOT / "CITATION.cff").read_text(encoding="utf-8")


@pytest.mark.parametrize("name", ["skin", "team", "field", "sweep", "own"])
def test_notebooks_are_pages_with_what_their_cells_gave(site, name):
    said = (site / "notebooks" / f"{name}.html").read_text(encoding="utf-8")
    assert f'href="{name}.ipynb"' in said
    assert (site / "notebooks" / f"{name}.ipynb").is_file()
    assert ("data:image/png" if name != "own" else "innervate-run") in said
