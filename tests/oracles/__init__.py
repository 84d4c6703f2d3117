"""Independent implementations for comparison in tests."""
