"""Pictures, movies and plots, without a display."""
