"""Live nodes: the protocols between real processes, over UDP, serial lines and in-process links."""
