"""Geometry of a camera over the WGS84 ellipsoid and of Web-Mercator pixels: arrays in, arrays out, no I/O.

In reading order:

- `ellipsoid`: radii, areas, and where rays meet the ground
- `lens`: cameras by their field of view, in plain numbers
- `camera`: what cameras see of which direction, and their poses
- `footprint`: the ground that the exact camera sees, its corners and its outline
- `reference`: coordinate reference systems that others define, without files
- `planes`: those of projected CRSs, and what they do to the ground
- `mercator`: Web Mercator, and the grid of a source's pixels
- `projections`: UTM, and a conformal plane about any place
- `vertical`: what heights count from, by name and code
- `local`: metres east, north and up of a place
- `sun`: where the sun stands
- `ways`: shortest ways around polygons of a plane
- `quaternions`: unit quaternions and rotations
- `frames`: map frames, rectangles of whole source pixels
- `rectangles`: the largest rectangles inside what cameras see
- `accuracy`: what each method may be wrong by, in closed form
- `view`: camera frames, from which pixels of which zooms each part is made
- `raytracing`: rays over relief, and camera frames made by them
"""
