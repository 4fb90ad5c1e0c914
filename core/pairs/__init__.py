"""Cross-view pairs: the same places from a satellite and from a drone, as University-1652 has them."""
