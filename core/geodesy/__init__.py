"""Geometry of a camera over the WGS84 ellipsoid and of Web-Mercator pixels: arrays in, arrays out, no I/O.

In reading order:

- `ellipsoid`: radii, areas, and intersections of rays with the ground
- `lens`: field of view, distortion and ground size of cameras, in plain numbers
- `distortion`: distortion of lenses, and its inverse
- `contract`: what the pixels of a picture mean, for other programs
- `camera`: rays and image points of cameras, and their poses
- `footprint`: the ground that the exact camera sees: corners and outline
- `reference`: reading coordinate reference systems safely, without files
- `planes`: the planes of projected CRSs, with scale, convergence and bend
- `mercator`: Web Mercator, and the pixel grid of a source
- `projections`: UTM, a conformal plane about any place, geodesics, and transformations
- `vertical`: vertical datums by name and code
- `local`: metres east, north and up from a place
- `gravity`: normal gravity, and the Earth's rotation
- `magnetic`: the Earth's main magnetic field
- `skins`: textures on triangles
- `triangles`: triangles in the Earth's frame
- `covered_roofs`: roofs beneath others
- `joined_faces`: several models of triangles as one
- `sun`: height and azimuth of the sun
- `sun_terms`: periodic terms of the sun's position
- `ways`: shortest ways around polygons in a plane
- `quaternions`: unit quaternions and rotations
- `frames`: map frames, rectangles of whole source pixels
- `rectangles`: the largest rectangles inside the ground that cameras see
- `interpolation`: polynomials along the sides of images
- `accuracy`: error bounds of each method, in closed form
- `areas`: pixels that average what they cover
- `spreading`: samples over what pixels cover, compiled
- `quadrilaterals`: cells of images that lenses bend
- `view`: camera frames, and the source pixels that each part is made of
- `covered`: the tiles under samples, compiled
- `raytracing`: rays over relief, and the camera frames made with them
"""
