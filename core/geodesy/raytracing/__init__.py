"""Rays over relief.

In reading order:

- `paths`: paths of rays in map coordinates, as polynomials
- `pixel_rays`: rays through the pixels of an image, straight or bent by a lens
- `pyramid`: greatest values of a grid's cells in ever larger blocks
- `kernels`: rays followed one by one, compiled by numba
- `surface`: heights on a grid, and the first hit of each ray
- `sampling`: samples of an image's pixels, compiled
- `seen`: the hits of an image on one surface, and the samples of its pixels
- `face_kernels`: triangles drawn one by one, compiled
- `faces`: the first triangle that each pixel's ray hits
- `seen_faces`: ground points, normals and samples of the pixels that see faces
- `tracing`: the rays of an image, the ground at its pixels, and its camera frame
"""
