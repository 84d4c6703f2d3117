"""Scenes in a browser, with viser (extra `view`): replay pages and a live view."""
