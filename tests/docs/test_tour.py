"""The scripts that take the documentation's pictures."""

import pytest

from tests.browser.servers import BROWSERS, MISSING, chromium


@pytest.mark.parametrize("name", BROWSERS)
def test_pictures_are_taken_in_each_browser_that_the_pages_are_tested_in(
    name, tmp_path, monkeypatch, capsys
):
    tour = pytest.importorskip("docs.tour", reason="playwright is missing")
    path = chromium()
    if path is None:
        pytest.skip(MISSING)
    monkeypatch.setattr(tour, "PICTURES", {})
    monkeypatch.setenv("PATH", str(tmp_path))
    assert tour.main([]) == 1
    assert capsys.readouterr().err == f"{MISSING}\n"
    (tmp_path / name).write_text(f'#!/bin/sh\nexec {path} "$@"\n')
    (tmp_path / name).chmod(0o755)
    assert tour.main([]) == 0
