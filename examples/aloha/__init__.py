"""Slotted ALOHA with acknowledgements, on a shared channel."""
