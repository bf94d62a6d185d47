"""docs/tutorial.md, command by command, in an empty folder."""

from pathlib import Path

from tests.docs.test_own_network import played
from tests.own import alone

__all__ = ["alone"]
PAGE = Path(__file__).resolve().parents[2] / "docs" / "tutorial.md"


def test_every_step_of_the_tutorial(alone, capfd):
    assert played(PAGE.read_text(encoding="utf-8"), capfd) >= 12
