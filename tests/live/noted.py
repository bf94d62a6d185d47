"""A medium that notes what it tells whom, in place of a socket."""

from innervate.live.channel import Medium
from innervate.live.channel_radio import JOIN, SEND, WHO, read_heard
from innervate.live.engine import clock_us

HERE, THERE = ("127.0.0.1", 9), ("127.0.0.1", 10)


class Noted:
    """A medium, and what it told whom: (kind, us since it began, carrier, one voice, port)."""

    def __init__(self, **medium):
        self.medium, self.told, self.began = Medium(**medium), [], clock_us()
        self.medium._socket = self

    def sendto(self, data, where):
        if data[:1] == WHO:
            return
        what, at, cd, voc, frame = read_heard(data)
        self.told.append(
            (what.decode(), at - self.began, cd, voc, where[1], *filter(None, [frame]))
        )

    def fileno(self):
        return -1

    def join(self, station, where=HERE):
        """True if the station is let in."""
        before = self.medium.unsound
        self.medium.take(JOIN.pack(b"J", station), where)
        return self.medium.unsound == before

    def send(self, station, slots=1, size=1, late_us=0, where=HERE):
        """True if a frame is taken."""
        before = self.medium.unsound
        data = SEND.pack(b"T", station, clock_us() - late_us, slots) + bytes(size)
        self.medium.take(data, where)
        return self.medium.unsound == before
