"""Raster files in any coordinate reference system as sources of imagery.

trust       checks of files before GDAL opens them: formats, and other files that they name
sizes       limits of bands, overviews, TIFF directories and blocks
virtual     bytes of files in archives and on other machines, as GDAL reads them
remote      files on other machines: GDAL's options for requests, and the version of a file
reading     rasters opened by GDAL or rasterio: facts, and pixels as they are stored
colours     the choice of bands, and which pixels have imagery
georeference  where pixels lie on the Web-Mercator map, exactly
resampling  means of the raster's pixels over those of the map
source      a raster file as a source on the map's pixel grid
"""
