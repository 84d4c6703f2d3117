"""``fgenv bench policies``: success rates of the policies, against ORCA."""
