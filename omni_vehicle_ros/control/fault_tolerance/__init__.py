"""Fault tolerance: how faults of wheels and sensors are seen, and what the vehicle still does with them."""
