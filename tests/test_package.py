"""`innervate.run` is one name for the room and for the function, however it was imported."""

import subprocess
import sys
from importlib.metadata import version

import pytest

import innervate

WAYS = {
    "lazily": "import innervate; call = innervate.run",
    "by from": "from innervate import run as call",
    "the function": "from innervate.run import run as call",
    "as a module": "import innervate.run as call",
    "after the room": "import innervate.run; call = innervate.run",
}


@pytest.mark.parametrize("way", WAYS.values(), ids=WAYS.keys())
def test_run_is_callable(way):
    code = f"""
{way}
import innervate, innervate.run as room
assert callable(call)
assert isinstance(room.Run, type)
try:
    call("there-is-no-such-file.toml")
except Exception as error:
    assert "there-is-no-such-file" in str(error), error
else:
    raise SystemExit("a scenario that is not there was run")
"""
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, timeout=120, check=False
    )
    assert done.returncode == 0, done.stderr + done.stdout


def test_unknown_attribute_of_the_package():
    with pytest.raises(AttributeError, match="walk"):
        innervate.walk  # noqa: B018


def test_version_is_the_distributions():
    assert version("innervate") == innervate.__version__
