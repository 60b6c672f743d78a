"""Control laws and small state machines: stamps and measurements in, set-points out; no ROS, no clock."""
