"""``fgenv bench fleets``: plans for many robots over frozen sets, method by method."""
