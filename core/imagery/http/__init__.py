"""Polite requests to providers.

transport           one attempt at one URL, over any HTTP library; what the headers of a response mean
client              requests of many threads: limits, retries, redirects, the meaning of a status
requests_transport  the transport of the headless core, which can be cancelled while it waits
"""
