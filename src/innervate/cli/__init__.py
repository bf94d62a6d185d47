"""The command line; heavy rooms are imported inside commands."""

from innervate.cli.app import main

__all__ = ["main"]
