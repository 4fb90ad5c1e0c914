"""Requests over QGIS's own network stack."""
