"""``fgenv bench world``: many bodies, movers among them, motions; fgenv against others."""
