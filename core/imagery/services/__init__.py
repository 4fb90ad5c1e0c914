"""Layers of map services, by the documents in which the services describe themselves.

detecting     the kind of service at an address
service       base class of all kinds: a layer as a mission names it
ogc           a layer of a WMTS or WMS
arcgis        a map or image service of ArcGIS Server
ogcapi        tiles of an OGC API
matrices      pixel grid of a tile matrix set
capabilities  fetching of documents; choices, formats and terms in them
json_service  base class of services with documents in JSON
"""
