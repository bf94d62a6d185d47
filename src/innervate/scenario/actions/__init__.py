"""What can be done to a network while it runs, by medium: words of [[event]]s, numbers."""

# Those that happen to a link; what the others happen to is a node.
ON_LINKS = ("cut", "restore", "loose", "lose")
