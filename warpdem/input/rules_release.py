"""Provisional."""

RULES = ()
