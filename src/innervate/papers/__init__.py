"""One file per published figure: scenario, run, measure, draw, claim against measurement."""
