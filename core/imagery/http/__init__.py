"""Polite requests to providers.

transport           protocol of a single attempt over any HTTP library; meaning of response headers
client              requests from many threads: limits, retries, redirects, meaning of a status
requests_transport  transport of the headless core, which can be cancelled while it waits
"""
