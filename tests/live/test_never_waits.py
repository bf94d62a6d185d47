"""Whatever carries frames never waits in the system: no datagram, port or caller holds up a node."""

import asyncio
import os
import pty
import socket

import pytest

from innervate.live.channel import Medium
from innervate.live.channel_radio import ChannelRadio
from innervate.live.machine import Machine, on
from innervate.live.serial import SerialLink
from innervate.live.udp import SwitchLink, UdpLink


class Watched(Machine):
    """This machine; it keeps what it was asked to open."""

    def __init__(self):
        self.opened = []

    def socket(self, family, kind):
        self.opened.append(super().socket(family, kind))
        return self.opened[-1]
