"""The blocks of the block diagram, without ROS: each takes messages by topic and answers once a control cycle.

The nodes put them on Fast DDS, the offline simulation calls them one after the other; the mathematics
is in :mod:`omni_vehicle_ros.model` and :mod:`omni_vehicle_ros.control`.
"""
