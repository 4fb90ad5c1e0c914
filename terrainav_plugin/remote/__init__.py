"""Remote datasets, on a web server or in an object store. No windows; on any thread.

address         address of a dataset's folder, and requests for its files
trust           servers and files that the user has agreed to
store           files at an address, whole or in part, over QGIS's network stack
geoparquet      the table of all images, converted to footprints and tables
copies          local copies of the files that footprints need
images          single images: local files, remote files, or parts of shards
"""
