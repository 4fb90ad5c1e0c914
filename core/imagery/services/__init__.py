"""Layers of services, described by the documents of the services.

detecting     the kind of service at an address
service       the base of all kinds: a layer as a mission names it
ogc           a layer of a WMTS or WMS
arcgis        a map or image service of ArcGIS Server
ogcapi        tiles of an OGC API
matrices      from a tile matrix set to a pixel grid
capabilities  fetching documents, and choices, formats and terms in them
json_service  documents in JSON
"""
