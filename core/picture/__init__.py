"""How a picture is made of a pose and its sources.

In reading order:

- `shot`: what a capture's picture is made from, and the picture
- `map_frame`: parts put together on the source's pixel grid
- `camera_frame`: tiles seen as the camera sees the ground
- `resampling`: values between an image's pixels
- `heights`: the heights of a mission, opened
- `products`: depth, ground points, normals and faces of every pixel
- `optics`: the camera at the moment of a picture
- `cost`: what pictures cost on this machine
"""
