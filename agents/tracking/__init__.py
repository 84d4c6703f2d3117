"""Tracking: actions that follow a plan or a velocity."""
