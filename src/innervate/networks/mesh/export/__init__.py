"""What other tools are given of a mesh."""
