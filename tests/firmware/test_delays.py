"""A frame that is to leave later is not for boards, whose drivers send at once: it is refused."""

import pytest

from boards import __main__ as boards
from innervate.firmware import library
from innervate.firmware.errors import FirmwareError
from innervate.live.board import roles_of
from innervate.live.errors import LiveError
from innervate.network import use
from tests.own import alone, own

__all__ = ["alone", "own"]


@pytest.mark.parametrize("delay", ["50", "node.value"])
def test_a_delay_is_refused_by_file_and_line(own, delay):
    assert "gossip.c" in library.made_of(str(own.folder), []).texts
    own.change("protocol.py", "send(out, port, 0, 0)", f"send(out, port, {delay}, 0)")
    at = own.line("protocol.py", f"{delay}, 0)")
    says = rf"gossip/protocol.py:{at}: boards send at once: give send a delay of 0, and send it fr"
    with pytest.raises(FirmwareError, match=says):
        library.made_of(str(own.folder), [])
    with pytest.raises(LiveError, match=says):
        boards.files_of(roles_of(use(own.folder))[0], {})
