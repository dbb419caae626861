"""Spikes from any numeric field of any topic, and values from spikes.

The modules beside `ros1` and `toolbox` know nothing of ROS: they are tested without it.
"""
