"""Planning methods for many robots."""
