"""RPL, the IPv6 routing protocol for low-power and lossy networks (RFC 6550), over a field."""
