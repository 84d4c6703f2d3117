"""Roadmaps: their construction, and timed motions along their edges."""
