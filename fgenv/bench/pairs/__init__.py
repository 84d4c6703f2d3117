"""``fgenv bench pairs``: collision queries on pairs of real meshes, against other libraries."""
