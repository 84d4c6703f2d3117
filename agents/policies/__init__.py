"""Policies that come along: `mlp:NAME` is NAME.npz here; each tells the command that made it."""
