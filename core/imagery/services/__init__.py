"""Layers of WMTS and WMS services, as their capabilities describe them.

ogc           a layer as a mission names it, and its entry of tiles
matrices      the tiles of a WMTS layer: one of its tile matrix sets, and what of it makes a grid
capabilities  the document: how it is fetched, and what both kinds of service have in common
"""
