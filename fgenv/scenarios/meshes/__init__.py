"""Meshes of the bodies in the built-in scenarios."""
