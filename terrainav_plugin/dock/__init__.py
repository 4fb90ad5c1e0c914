"""The panel: what is typed, chosen and shown there."""
