"""How fast things are: ratios measured in one run, on one machine."""
