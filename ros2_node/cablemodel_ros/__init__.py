"""The ROS 2 node of cablemodel.

Everything but ``node``, ``messages`` and ``markers`` is free of rclpy: plain classes that tests
and other programs drive alone.
"""
