"""What can be done to a network while it runs, by medium: words of [[event]]s, numbers."""
