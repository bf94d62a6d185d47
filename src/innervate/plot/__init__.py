"""Drawings of runs as SVG and HTML, and what their sentences are made of."""
