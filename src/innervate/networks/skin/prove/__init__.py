"""What is proved of the skin's protocol, for any number of cells and any cables (docs/prove.md)."""
