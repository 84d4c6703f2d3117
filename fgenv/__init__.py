"""Exact, fast collision detection by feature graphs, for environments of many robots."""

__version__ = "0.1.0"
