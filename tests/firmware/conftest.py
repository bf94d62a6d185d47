"""What several files of tests here need, made once."""

import pytest

from tests.firmware import in_c


@pytest.fixture(scope="session")
def native(tmp_path_factory):
    """All of C that seals, with the example's algorithms."""
    return in_c.built(tmp_path_factory.mktemp("seal"))
