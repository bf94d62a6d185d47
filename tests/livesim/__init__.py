"""Whole networks of live nodes in one process under simulated time, hurt in every way."""
