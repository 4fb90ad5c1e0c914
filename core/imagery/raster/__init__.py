"""Raster files in any coordinate reference system as sources of imagery.

trust       what GDAL may open: pictures on this machine, and no more than the user has named
sizes       how much of anything a raster may have
virtual     bytes of files in archives and on other machines, as GDAL reads them
remote      files on other machines: what GDAL is told of requests, and which version of a file they are for
reading     the libraries that read them: facts, and pixels as they are stored
colours     which bands make a picture, and what of it is no imagery
georeference  where pixels lie on the Web-Mercator map, exactly
resampling  colours of the map's pixels out of the raster's
source      a raster file as a source on the map's pixel grid
"""
