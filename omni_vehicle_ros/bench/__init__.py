"""Measurements of how fast this package is, beside what others need for the same."""
