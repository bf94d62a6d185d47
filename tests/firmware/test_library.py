"""A library's files in a folder."""

from types import SimpleNamespace

import pytest

from innervate.firmware import library
from innervate.firmware.errors import FirmwareError

FILES = SimpleNamespace(library=SimpleNamespace(prefix="own"), texts={"own.h": "int a;\n"})


def test_a_file_is_there_whole_or_not_at_all(tmp_path, full_disk):
    with full_disk(), pytest.raises(FirmwareError, match=r"own\.h cannot be written"):
        library.write(FILES, tmp_path)
    assert list(tmp_path.iterdir()) == []
    assert library.write(FILES, tmp_path) == {"own.h": 1}
    assert [path.name for path in tmp_path.iterdir()] == ["own.h"]
