"""The network of a robot skin: cells find routes to a PC and mend them."""
