"""Geometry of a camera over the WGS84 ellipsoid and of Web-Mercator pixels: arrays in, arrays out, no I/O."""
