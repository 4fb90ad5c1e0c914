"""Layers of WMTS and WMS services, as their capabilities describe them.

ogc           a layer as a mission names it, and its entry of tiles
capabilities  the document: how it is fetched, and what both kinds of service have in common
safe_xml      XML of strangers
"""
