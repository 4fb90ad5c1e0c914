"""What a real camera does to light: arrays in, arrays out.

In reading order:

- `light`: linear light and the values of images, exposure, white balance
- `air`: haze
- `optics`: vignetting
- `shutter`: times of rows and instants, strips of rows
- `sensor`: photons, electrons and digital numbers after EMVA 1288
- `bayer`: patterns of colour filters, and demosaicing
- `varying`: random values of images, by distributions
"""
