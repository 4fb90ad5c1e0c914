"""Where pixels come from: sources, how missions name them, their transport and cache.

source       what a source is to the rest: windows, parts, tiles, pixels
policy       what a provider allows
systems      coordinate reference systems that services offer
template     URL templates of tiles, and the keys in addresses
entry        a source by name: where its tiles are, their dates, grid and terms
opening      from the text in a mission to one value that tells all of the source, and opens it
catalogue    the sources known by name, shipped and the user's own; terms are checked here
xyz          tiles by URL template
staticmap    Google Static Maps
mbtiles      a user's own MBTiles file
decode       from the bytes of an answer to pixels
placeholder  pictures by which providers say that they have none

services, raster, http and cache are rooms of their own.
"""
