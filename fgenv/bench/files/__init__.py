"""Files of other programs: our readers against independent ones on all files in pip packages."""
