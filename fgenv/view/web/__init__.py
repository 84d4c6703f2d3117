"""Scenes in a browser, by viser (extra `view`): pages that play an episode, and a live view."""
