"""Raster files in any coordinate reference system as sources of imagery.

trust       checks before GDAL opens a file: formats, and further files that the file names
sizes       limits of bands, overviews, TIFF directories and blocks
virtual     reading of bytes of files in archives and on other machines by GDAL
remote      files on other machines: GDAL's options for requests, and the version of a file
reading     facts and stored pixels of rasters, by GDAL or rasterio
colours     choice of bands, and the mask of pixels with imagery
georeference  exact position of pixels on the Web-Mercator map
resampling  means of the raster's pixels within each pixel of the map
source      a raster file as a source on the map's pixel grid
"""
