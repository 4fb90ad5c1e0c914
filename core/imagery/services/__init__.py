"""Layers of WMTS and WMS services, as their capabilities describe them."""
