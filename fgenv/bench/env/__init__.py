"""``fgenv bench env``: steps of many robots in many worlds; fgenv against others."""
