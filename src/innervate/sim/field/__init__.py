"""Nodes that share a radio medium in which not everybody hears everybody: the mesh's simulator."""
