"""Safe interval path planning among moving robots."""
