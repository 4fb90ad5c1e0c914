"""Layers of services, as their own descriptions tell of them.

detecting     which kind of service is at an address
service       a layer as a mission names it, whatever kind of service that is
ogc           a layer of a WMTS or WMS as a mission names it, and its entry of tiles
arcgis        a map or image service of ArcGIS Server
ogcapi        tiles of an OGC API
matrices      the tiles of a layer: one of its tile matrix sets, and what of it makes a grid
capabilities  the document: how it is fetched, and what all kinds of service have in common
json_service  documents in JSON
safe_xml      XML of strangers
"""
