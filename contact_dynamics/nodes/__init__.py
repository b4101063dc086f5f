"""ROS 2 nodes: parameters and messages in, one physics call, messages out."""
