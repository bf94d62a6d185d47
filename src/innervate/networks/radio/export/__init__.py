"""What other tools are given of a radio team."""
