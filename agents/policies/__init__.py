"""Policies, one file each; `fgenv.registration` lists their factories by name."""
