"""Report of a mission: error against run time of its methods and of others, measured on its captures.

In reading order:

- `measure`: every method timed and measured, and whole images
- `footprints`: cheaper methods of footprints, for comparison
- `pixels`: ways to place the pixels of a camera frame, for comparison
- `positions`: errors of positions, measured in long double
- `pictures`: pictures by any method: run time, file size, errors in grey levels
- `wind`: effect of wind on a mission
- `sharpness`: sharpness of images from a slanted edge
- `conditioning`: condition numbers over tilt and height
- `tables`: figures as tables and as CSV
- `sentences`: figures in words
- `plots`: diagrams
- `heights`: height profiles as tables and diagrams
- `machine`: processor, system and software versions
- `page`: the page
"""
