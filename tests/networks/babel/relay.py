"""python relay.py OWN PEER DEVICE: Babel's packets, as they are, from a live node to an interface.

A live node's paths are of IPv4, and Babel's neighbours hear each other over IPv6, at ff02::1:6.
"""

import select
import socket
import struct
import sys

GROUP, PORT = "ff02::1:6", 6696


def main(own, peer, device):
    """Carry packets between UDP port `peer` of this machine, that is told `own`, and the device."""
    node = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    node.bind(("127.0.0.1", own))
    index = socket.if_nametoindex(device)
    link = socket.socket(socket.AF_INET6, socket.SOCK_DGRAM)
    link.setsockopt(socket.IPPROTO_IPV6, socket.IPV6_V6ONLY, 1)
    link.bind(("::", PORT))
    member = socket.inet_pton(socket.AF_INET6, GROUP) + struct.pack("@I", index)
    link.setsockopt(socket.IPPROTO_IPV6, socket.IPV6_JOIN_GROUP, member)
    link.setsockopt(socket.IPPROTO_IPV6, socket.IPV6_MULTICAST_IF, index)
    link.setsockopt(socket.IPPROTO_IPV6, socket.IPV6_MULTICAST_LOOP, 0)
    while True:
        for came in select.select([node, link], [], [])[0]:
            data = came.recv(2048)
            if came is node:
                link.sendto(data, (GROUP, PORT, 0, index))
            else:
                node.sendto(data, ("127.0.0.1", peer))


if __name__ == "__main__":
    main(int(sys.argv[1]), int(sys.argv[2]), sys.argv[3])
