"""``fgenv bench limits``: worst times of inputs at the limit of rounding."""
