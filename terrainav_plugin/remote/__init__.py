"""Datasets at addresses: on a web server, in an object store. Knows no window; on any thread.

address         what a user gives: a folder's address, and where its files are asked for
trust           servers and files that the user has agreed to
store           the files at an address, whole or in part, over QGIS's own network stack
geoparquet      all images in one table, as footprints and tables
copies          what footprints need, copied to this machine once
images          the bytes of one image: a file here, one at an address, or a part of a shard
"""
