"""Requests over QGIS's own network stack.

transport       transport for the core: returns a response for a URL
worker          makes the requests on the main thread, for waiting threads
answers         converts Qt's replies to responses and errors
"""
