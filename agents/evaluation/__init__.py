"""Evaluation of policies on frozen sets of cases."""
