"""Requests over QGIS's own network stack.

transport       what the core asks: a response for an address
worker          the requests themselves, made in the main thread for threads that wait
answers         what a reply of Qt's says
"""
