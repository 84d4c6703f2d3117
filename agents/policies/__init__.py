"""Policies of the robots, a file each."""
