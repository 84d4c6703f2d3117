"""Roadmaps with timed edges: construction, motion tables, collision cache."""
