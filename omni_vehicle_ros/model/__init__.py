"""Physics of the vehicle: pure functions on floats and tuples; no ROS, no clock, no files."""
