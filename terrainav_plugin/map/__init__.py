"""What lies on the map: the box, footprints, backgrounds, mosaics and results."""
