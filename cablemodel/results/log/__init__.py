"""The log of a run: an MCAP file that rosbag2 and Foxglove read without this project.

It holds what viewers show (ROS 2 messages of the table in :mod:`cablemodel.variables`) and what
a replay needs exactly (applied inputs of every step, states in 64-bit floats, the scene).
"""
