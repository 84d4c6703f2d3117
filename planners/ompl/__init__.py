"""OMPL: state spaces, validity checkers and objectives on a world of fgenv."""
