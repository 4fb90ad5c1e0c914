"""Requests over QGIS's own network stack.

transport       the core's transport: a response for a URL
worker          the requests, made on the main thread for waiting threads
answers         responses and errors from Qt's replies
"""
