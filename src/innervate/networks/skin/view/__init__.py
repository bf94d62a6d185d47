"""What the live page shows of a skin."""
