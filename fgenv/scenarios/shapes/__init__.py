"""Shapes as a scenario file describes them: a kind, and its sizes."""
