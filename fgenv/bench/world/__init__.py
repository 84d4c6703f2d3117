"""``fgenv bench world``: many bodies, movers among them, motions; against libraries that do them."""
