"""What a real camera does to light: arrays in, arrays out.

In reading order:

- `light`: linear light and the values of images
"""
