"""The ROS 2 nodes, which take parameters and messages, ask the library once, and send messages."""
