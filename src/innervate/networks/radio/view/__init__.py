"""What the live page shows of a radio team."""
