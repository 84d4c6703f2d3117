"""The published method in NumPy, the baselines of its comparison, and its figures."""
