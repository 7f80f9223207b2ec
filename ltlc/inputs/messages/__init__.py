"""Definitions of ROS messages: their fields and constants, those of ROS 2 Jazzy and those in folders."""
