"""The command line; heavy rooms are imported inside commands."""
