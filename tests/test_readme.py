"""The README as a package index shows it: outside the repository, where no path leads anywhere."""

import re
from pathlib import Path

import pytest
from hatchling.metadata.core import ProjectMetadata
from hatchling.plugin.manager import PluginManager

ROOT = Path(__file__).resolve().parents[1]
ADDRESS = "https://code.example/robots/innervate"
RELATIVE = re.compile(r"\]\((?!https:|#)|src=\"(?!https:)")


@pytest.fixture
def core(monkeypatch):
    """The core metadata of what is built, where the address is as said."""

    def of(address):
        monkeypatch.setenv("INNERVATE_ADDRESS", address)
        return ProjectMetadata(str(ROOT), PluginManager()).core

    return of


def test_with_an_address_all_pictures_and_links_lead_there(core):
    found = core(ADDRESS + "/")
    assert not RELATIVE.search(found.readme)
    there = (ROOT / "README.md").read_text(encoding="utf-8")
    assert found.readme.count(f"{ADDRESS}/raw/HEAD/docs/images/") == there.count("docs/images/")
    led = re.findall(rf"{ADDRESS}/(?:raw|blob)/HEAD/([^)#\"]+)", found.readme)
    assert len(led) > 40
    assert [one for one in led if not (ROOT / one).exists()] == []
    assert set(found.urls) == {"Source", "Documentation", "Changelog", "Issues"}
    for one in found.urls.values():
        assert one.startswith(ADDRESS)
        _, at, page = one.partition("/blob/HEAD/")
        assert not at or (ROOT / page).is_file()


def test_without_one_no_picture_is_broken_and_nothing_else_is_lost(core):
    found = core("")
    assert not RELATIVE.search(found.readme)
    assert "![" not in found.readme
    assert "<img" not in found.readme
    assert found.urls == {}
    for words in ("The first quarter of an hour", "pip install", "innervate watch demo"):
        assert words in found.readme


@pytest.mark.parametrize("address", ["code.example/robots", "https://code.example", "http://a/b"])
def test_an_address_that_is_none_is_refused(core, address):
    with pytest.raises(ValueError, match="INNERVATE_ADDRESS must be like https://HOST/OWNER/NAME"):
        core(address).readme  # noqa: B018
