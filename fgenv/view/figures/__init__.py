"""Pictures, movies and plots, drawn without a display."""
