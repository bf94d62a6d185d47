"""The ring is one of the networks: here, and in every process that is started from here."""

from pathlib import Path

import pytest

from innervate.network import networks


@pytest.fixture(autouse=True)
def known(monkeypatch):
    monkeypatch.setenv("INNERVATE_NETWORKS", str(Path(__file__).parent))
    networks.cache_clear()
    yield
    networks.cache_clear()
