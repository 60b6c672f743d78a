"""Bags of any length, reduced while they are read: what is kept does not grow with the bag."""
