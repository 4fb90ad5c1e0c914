"""Layers of WMTS and WMS services, as their capabilities describe them.

ogc           a layer as a mission names it
capabilities  the document: how it is fetched, and what both kinds of service have in common
wmts, wms     layers of each kind, as entries of tiles
safe_xml      XML of strangers
"""
