"""``fgenv bench planners``: OMPL on fgenv's checks against OMPL on checkers written in Python."""
