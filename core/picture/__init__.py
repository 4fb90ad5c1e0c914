"""Pictures, made of tiles for the poses of a plan.

In reading order:

- `shot`: a capture to be drawn, and its picture
- `painting`: colours of faces that no imagery shows, in the light of the sun
- `map_frame`: map frames, assembled on the source's pixel grid
- `camera_frame`: camera frames, resampled from tiles
- `resampling`: values between an image's pixels
- `taps`: bilinear values and means of areas, compiled
- `perspective`: perspective transforms, compiled
- `heights`: opens the heights of a mission
- `labels`: opens the labels of a mission
- `products`: depth, ground points, normals, faces, classes and instances of every pixel
- `optics`: the camera of a picture: focal length, principal point, time
- `scene`: a picture's light on its way through a camera
- `photometry`: haze, vignetting, exposure, white balance and tone
- `sensor`: the image sensor's part in it
- `effects`: what a real camera makes of a picture
- `cost`: processor time of pictures on this machine
"""
