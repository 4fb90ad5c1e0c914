"""Well-mannered requests to providers.

transport           what one attempt at one URL has to be, over whatever stack of HTTP
client              requests of many threads: limits, trying again, what an answer's status means
requests_transport  the transport of the headless core, which can be ended while it waits
"""
