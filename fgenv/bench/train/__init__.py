"""``fgenv bench train``: samples per CPU-second during training."""
