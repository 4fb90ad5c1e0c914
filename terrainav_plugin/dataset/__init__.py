"""A dataset cleaned by eye: its entropies, a threshold, and what would be rejected by it."""
