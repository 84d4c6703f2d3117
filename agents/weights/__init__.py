"""Trained policies that the package includes: `mlp:NAME` is NAME.npz."""
