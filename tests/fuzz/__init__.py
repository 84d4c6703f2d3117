"""Fuzzing by bytes. Each target holds one function from bytes to laws that must not break."""
