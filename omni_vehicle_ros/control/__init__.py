"""Control laws and small state machines: stamps and measurements come in, set-points go out; no ROS, no clock."""
